// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>
#include <cstdint>

namespace pm {

// Bits of three numbers below 2^16, one after another, the first number's before the others'.
inline std::uint64_t mortonKey(const std::array<std::uint32_t, 3>& cell) {
    std::uint64_t key = 0;
    for (int bit = 15; bit >= 0; --bit)
        for (const std::uint32_t number : cell) key = key << 1 | (number >> bit & 1);
    return key;
}

}  // namespace pm
