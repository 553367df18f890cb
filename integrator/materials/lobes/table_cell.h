// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <algorithm>
#include <cstddef>

namespace pm {

// Where in a table of values at 0, 1 / (size - 1), ... 1 a place lies: between low and low + 1.
struct TableCell {
    std::size_t low;
    float part;

    // at: clamped to [0, 1]; size: 2 or more.
    TableCell(float at, std::size_t size) {
        const float x = std::clamp(at, 0.0f, 1.0f) * static_cast<float>(size - 1);
        low = std::min(static_cast<std::size_t>(x), size - 2);
        part = x - static_cast<float>(low);
    }
};

}  // namespace pm
