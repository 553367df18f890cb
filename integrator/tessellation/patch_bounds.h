// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>

#include "integrator/geometry/face_pattern.h"
#include "integrator/values/box.h"

namespace pm {

// A box that holds a bicubic patch over part of its parameters: that of its Bezier points there,
// which follow from 4 x 4 points of the patch. position(uv): a Vec3d.
template <typename Position>
Box3d boundsOfBicubic(const PatternDomain& domain, const Position& position) {
    // The cubic's Bezier points from its values at 0, 1/3, 2/3 and 1.
    const auto toBezier = [](std::array<Vec3d, 4>& p) {
        const Vec3d b1 = (p[0] * -5.0 + p[1] * 18.0 - p[2] * 9.0 + p[3] * 2.0) / 6.0,
                    b2 = (p[0] * 2.0 - p[1] * 9.0 + p[2] * 18.0 - p[3] * 5.0) / 6.0;
        p[1] = b1;
        p[2] = b2;
    };
    const auto between = [](double lo, double hi, std::size_t third) {
        return third == 3 ? hi : lo + (hi - lo) * (static_cast<double>(third) / 3.0);
    };
    std::array<std::array<Vec3d, 4>, 4> points;  // by v, then u
    for (std::size_t j = 0; j < 4; ++j) {
        for (std::size_t i = 0; i < 4; ++i)
            points[j][i] = position(std::array{between(domain.lo[0], domain.hi[0], i),
                                               between(domain.lo[1], domain.hi[1], j)});
        toBezier(points[j]);
    }
    Box3d box;
    for (std::size_t i = 0; i < 4; ++i) {
        std::array<Vec3d, 4> column{points[0][i], points[1][i], points[2][i], points[3][i]};
        toBezier(column);
        for (const Vec3d& point : column) box.grow({point, point});
    }
    return box;
}

}  // namespace pm
