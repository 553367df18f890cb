// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <algorithm>
#include <cstdint>

namespace pm {

// Half-open rectangle of pixels [x0,x1) x [y0,y1); origin top left, y down, in the display window.
// Coordinates may be negative (overscan).
struct Rect {
    std::int32_t x0{}, y0{}, x1{}, y1{};

    constexpr std::int32_t width() const { return x1 - x0; }
    constexpr std::int32_t height() const { return y1 - y0; }
    constexpr bool empty() const { return x1 <= x0 || y1 <= y0; }
    constexpr std::int64_t area() const {
        return empty() ? 0 : static_cast<std::int64_t>(width()) * height();
    }
    constexpr bool contains(std::int32_t x, std::int32_t y) const {
        return x >= x0 && x < x1 && y >= y0 && y < y1;
    }
    friend constexpr bool operator==(const Rect& a, const Rect& b) = default;
};

constexpr Rect intersect(const Rect& a, const Rect& b) {
    return {std::max(a.x0, b.x0), std::max(a.y0, b.y0), std::min(a.x1, b.x1), std::min(a.y1, b.y1)};
}

}  // namespace pm
