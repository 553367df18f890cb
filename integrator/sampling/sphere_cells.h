// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <utility>

#include "integrator/sampling/pinned_math.h"
#include "integrator/values/vec.h"

namespace pm {

// The sphere of directions as a square in which areas are solid angles, and nowhere much stretched:
// the upper half of the sphere is the square's inner diamond, its four corners are folded down.
// Source: Clarberg, "Fast Equal-Area Mapping of the (Hemi)Sphere using SIMD", JGT 13(3), 2008.
inline Vec3f squareToSphere(Vec2f u) {
    const float x = 2.0f * u.x - 1.0f, y = 2.0f * u.y - 1.0f;
    const float up = 1.0f - (std::abs(x) + std::abs(y));
    const float r = 1.0f - std::abs(up);
    const float eighths = r > 0.0f ? (std::abs(y) - std::abs(x)) / r + 1.0f : 1.0f;
    const SinCos around = sinCosTurns(std::clamp(eighths, 0.0f, 2.0f) / 8.0f);
    const float across = r * std::sqrt(std::max(0.0f, 2.0f - r * r));
    return {std::copysign(around.cos, x) * across, std::copysign(1.0f - r * r, up),
            std::copysign(around.sin, y) * across};
}

// The same backwards; [0, 1]^2.
inline Vec2f sphereToSquare(const Vec3f& direction) {
    const float r = std::sqrt(std::max(0.0f, 1.0f - std::abs(direction.y)));
    const auto quarter =
        static_cast<float>(4.0 * pinnedAtan2Turns(static_cast<double>(std::abs(direction.z)),
                                                  static_cast<double>(std::abs(direction.x))));
    float y = quarter * r, x = r - y;
    if (direction.y < 0.0f) {
        x = 1.0f - std::exchange(y, 1.0f - x);
    }
    return {0.5f + 0.5f * std::copysign(x, direction.x),
            0.5f + 0.5f * std::copysign(y, direction.z)};
}

// Cells of that square, kSide by kSide, row by row: of equal solid angle.
template <std::uint32_t kSideCells>
struct SphereCells {
    static constexpr std::uint32_t kSide = kSideCells;
    static constexpr std::uint32_t kCount = kSide * kSide;
    static constexpr float kSolidAngle = 4.0f * std::numbers::pi_v<float> / kCount;  // of a cell

    // In which cell a unit direction is.
    static std::uint32_t cellOf(const Vec3f& direction) {
        const Vec2f at = sphereToSquare(direction);
        const auto indexOf = [](float v) {
            return std::min(static_cast<std::uint32_t>(std::max(0.0f, v) * kSide), kSide - 1);
        };
        return kSide * indexOf(at.y) + indexOf(at.x);
    }

    // A unit direction, uniform over the cell for u uniform in [0, 1)^2, but for rounding.
    static Vec3f directionIn(std::uint32_t cell, Vec2f u) {
        return squareToSphere({(static_cast<float>(cell % kSide) + u.x) / kSide,
                               (static_cast<float>(cell / kSide) + u.y) / kSide});
    }

    // The cell beside another, at (column, row) -1 to kSide, which may be one step beyond the
    // square: its edges are folded in the middle.
    static std::uint32_t cellAt(std::int32_t column, std::int32_t row) {
        const auto last = static_cast<std::int32_t>(kSide) - 1;
        const auto fold = [last](std::int32_t& over, std::int32_t& along) {
            if (over >= 0 && over <= last) return;
            over = std::clamp(over, 0, last);
            along = last - along;
        };
        fold(column, row);
        fold(row, column);
        return kSide * static_cast<std::uint32_t>(row) + static_cast<std::uint32_t>(column);
    }
};

}  // namespace pm
