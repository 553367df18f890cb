// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cmath>

#include "integrator/values/transform.h"
#include "integrator/values/vec.h"

namespace pm {

// The transform of normals up to a positive factor: the transposed inverse, whose rows are cross
// products of the matrix's rows over its determinant. The sign keeps the front in front.
struct NormalTransform {
    Vec3d rows[3];

    explicit NormalTransform(const Transform& m)
        : rows{cross(row(m, 1), row(m, 2)), cross(row(m, 2), row(m, 0)),
               cross(row(m, 0), row(m, 1))} {
        if (determinant(m) < 0)
            for (Vec3d& r : rows) r = -r;
    }
    Vec3f apply(const Vec3f& n) const {
        const Vec3d nd(n);
        const Vec3d v{dot(rows[0], nd), dot(rows[1], nd), dot(rows[2], nd)};
        const double l = length(v);
        return l > 0 ? Vec3f(v / l) : n;
    }
};

// The factor of a transform that keeps spheres spheres; 0 when it does not.
inline double uniformScale(const Transform& m) {
    const double s0 = length(row(m, 0)), s1 = length(row(m, 1)), s2 = length(row(m, 2));
    const double tolerance = 1e-6 * s0;
    const bool uniform = std::abs(s1 - s0) <= tolerance && std::abs(s2 - s0) <= tolerance &&
                         std::abs(dot(row(m, 0), row(m, 1))) <= tolerance * s0 &&
                         std::abs(dot(row(m, 0), row(m, 2))) <= tolerance * s0 &&
                         std::abs(dot(row(m, 1), row(m, 2))) <= tolerance * s0;
    return uniform ? s0 : 0.0;
}

}  // namespace pm
