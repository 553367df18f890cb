// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "plugin/parameters/packed_values.h"

#include <algorithm>

namespace pm::plugin {

namespace {

template <typename Entries>
auto entryOf(Entries& entries, std::size_t row) {
    return std::ranges::find_if(entries, [&](const auto& entry) { return entry.first == row; });
}

// isThere: whether the value is one to keep.
template <typename Entries, typename T>
void replaceEntry(Entries& entries, std::size_t row, bool isThere, T&& value) {
    const auto found = entryOf(entries, row);
    if (found != entries.end() && !isThere)
        entries.erase(found);
    else if (found != entries.end())
        found->second = std::forward<T>(value);
    else if (isThere)
        entries.emplace_back(static_cast<std::uint16_t>(row), std::forward<T>(value));
}

}  // namespace

ParameterValue PackedValues::get(std::size_t row) const {
    ParameterValue value;
    value.numbers.assign(m_numbers.begin() + m_begins[row], m_numbers.begin() + m_begins[row + 1]);
    if (const auto text = entryOf(m_texts, row); text != m_texts.end()) value.text = text->second;
    if (const auto texture = entryOf(m_textures, row); texture != m_textures.end())
        value.texture = texture->second;
    return value;
}

void PackedValues::put(std::size_t row, ParameterValue value) {
    const std::size_t begin = m_begins[row], held = m_begins[row + 1] - begin;
    const std::size_t given = value.numbers.size();
    if (given != held) {
        std::vector<double> numbers;
        numbers.reserve(m_numbers.size() - held + given);
        const auto from = m_numbers.begin() + static_cast<std::ptrdiff_t>(begin);
        numbers.assign(m_numbers.begin(), from);
        numbers.insert(numbers.end(), value.numbers.begin(), value.numbers.end());
        numbers.insert(numbers.end(), from + static_cast<std::ptrdiff_t>(held), m_numbers.end());
        m_numbers = std::move(numbers);
        for (std::size_t i = row + 1; i < m_begins.size(); ++i)
            m_begins[i] = static_cast<std::uint16_t>(m_begins[i] + given - held);
    } else {
        std::ranges::copy(value.numbers, m_numbers.begin() + static_cast<std::ptrdiff_t>(begin));
    }
    const bool hasText = !value.text.empty(), hasTexture = value.texture != nullptr;
    replaceEntry(m_texts, row, hasText, std::move(value.text));
    replaceEntry(m_textures, row, hasTexture, std::move(value.texture));
}

}  // namespace pm::plugin
