// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <bit>
#include <cstdint>
#include <vector>

namespace pm {

// Marks on the numbers 0 to n - 1, and the first marked one from a number on, all round: words of
// 64 marks, and above them words that say which of these hold any. One thread.
class RingMarks {
  public:
    static constexpr std::uint32_t kNone = 0xffffffffu;

    // All are marked.
    void reset(std::uint32_t count) {
        m_levels.resize(1);
        fill(m_levels[0], count);
        while (m_levels.back().size() > 1) {
            const auto words = static_cast<std::uint32_t>(m_levels.back().size());
            fill(m_levels.emplace_back(), words);
        }
    }

    void set(std::uint32_t i) {
        for (auto& level : m_levels) {
            std::uint64_t& word = level[i / 64];
            const bool hadAny = word != 0;
            word |= std::uint64_t{1} << i % 64;
            if (hadAny) return;
            i /= 64;
        }
    }

    void clear(std::uint32_t i) {
        for (auto& level : m_levels) {
            std::uint64_t& word = level[i / 64];
            word &= ~(std::uint64_t{1} << i % 64);
            if (word != 0) return;
            i /= 64;
        }
    }

    // The first marked one of i, i + 1, ..., n - 1, 0, ..., i - 1; kNone where none is.
    std::uint32_t firstFrom(std::uint32_t i) const {
        const std::uint32_t found = firstAtOrAfter(i);
        return found != kNone || i == 0 ? found : firstAtOrAfter(0);
    }

  private:
    static void fill(std::vector<std::uint64_t>& words, std::uint32_t count) {
        words.assign((count + 63) / 64, ~std::uint64_t{0});
        if (count % 64 != 0) words.back() = (std::uint64_t{1} << count % 64) - 1;
    }

    std::uint32_t firstAtOrAfter(std::uint32_t i) const {
        for (std::size_t level = 0; level < m_levels.size(); ++level) {
            if (i / 64 >= m_levels[level].size()) return kNone;
            const std::uint64_t rest = m_levels[level][i / 64] >> i % 64 << i % 64;
            if (rest != 0) return down(level, i / 64 * 64 + lowest(rest));
            i = i / 64 + 1;
        }
        return kNone;
    }

    std::uint32_t down(std::size_t level, std::uint32_t i) const {
        while (level-- > 0) i = i * 64 + lowest(m_levels[level][i]);
        return i;
    }

    static std::uint32_t lowest(std::uint64_t word) {
        return static_cast<std::uint32_t>(std::countr_zero(word));
    }

    std::vector<std::vector<std::uint64_t>> m_levels;
};

}  // namespace pm
