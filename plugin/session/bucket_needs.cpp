// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "plugin/session/bucket_needs.h"

#include <algorithm>
#include <limits>

namespace pm::plugin {

BucketNeeds::BucketNeeds(const BucketGrid& grid, const GroupCache& cache)
    : m_grid(grid), m_cache(cache), m_keys(grid.cellCount()) {}

void BucketNeeds::append(std::uint32_t cell, std::vector<std::uint32_t>& keys) const {
    keys.insert(keys.end(), m_keys[cell].begin(), m_keys[cell].end());
}

float BucketNeeds::missing(std::uint32_t cell) const {
    std::vector<std::uint32_t> keys;
    {
        const std::lock_guard lock(m_mutex);
        append(cell, keys);
        if (keys.empty()) {
            const auto columns = static_cast<std::uint32_t>(m_grid.columns());
            const std::uint32_t column = cell % columns;
            if (column > 0) append(cell - 1, keys);
            if (column + 1 < columns) append(cell + 1, keys);
            if (cell >= columns) append(cell - columns, keys);
            if (m_grid.cellCount() - cell > columns) append(cell + columns, keys);
        }
    }
    if (keys.empty()) return std::numeric_limits<float>::quiet_NaN();
    const auto held =
        std::ranges::count_if(keys, [&](std::uint32_t key) { return m_cache.holds(key); });
    return 1.0f - static_cast<float>(held) / static_cast<float>(keys.size());
}

void BucketNeeds::add(std::uint32_t cell, std::vector<std::uint32_t>& keys) {
    std::ranges::sort(keys);
    keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
    const std::lock_guard lock(m_mutex);
    std::vector<std::uint32_t> both;
    std::ranges::set_union(m_keys[cell], keys, std::back_inserter(both));
    m_keys[cell] = std::move(both);
}

BucketNeeds::Noting::~Noting() {
    if (m_needs && !m_keys.empty()) m_needs->add(m_cell, m_keys);
}

void BucketNeeds::Noting::asked(const CacheAsked& what) {
    if (what.cache == m_needs->m_cache.number()) {
        const auto key = static_cast<std::uint32_t>(what.key);
        if (m_keys.empty() || m_keys.back() != key) m_keys.push_back(key);
    }
    if (m_next) m_next->asked(what);
}

}  // namespace pm::plugin
