// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// [1] Hanika, "Hacking the Shadow Terminator", Ray Tracing Gems II, 2021, chapter 4.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "integrator/values/vec.h"

namespace pm {

// A point of the curved surface that a triangle with normals of its vertices stands for.
struct SmoothPoint {
    Vec3d position;
    Vec3f normal;  // unit, interpolated, on the side that was asked for
};

// Over the point of a triangle with these barycentric coordinates: the point's projections on the
// planes of the vertices' normals, in proportion to its coordinates; where the surface is hollow,
// the triangle itself. normals: unit, on one side. [1], eq. 1 and listing 4-1.
inline Vec3d liftedPoint(const std::array<Vec3d, 3>& vertices, const std::array<Vec3f, 3>& normals,
                         const std::array<double, 3>& barycentric) {
    Vec3d point;
    for (std::size_t i = 0; i < 3; ++i) point += vertices[i] * barycentric[i];
    Vec3d lift;
    for (std::size_t i = 0; i < 3; ++i) {
        const Vec3d normal(normals[i]);
        const double depth = std::min(0.0, dot(point - vertices[i], normal));
        lift += normal * (-depth * barycentric[i]);
    }
    return point + lift;
}

}  // namespace pm
