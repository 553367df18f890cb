// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <algorithm>
#include <cmath>

#include "integrator/shapes/instance_transform.h"
#include "integrator/values/transform.h"
#include "integrator/values/vec.h"

namespace pm {

// Where a shared mesh stands, in the scene's own coordinates.
//
// Rays are intersected with it in its own space, to which Embree takes them in float. With
// u = 2^-24, M the linear part of toScene, t its translation, W = M^-1 and k = |M| |W|, the largest
// sum of a row: rounded to float, inverted by cofactors and applied, W and its translation are off
// by about 8 u k of their size, and a point by u more. Back in the scene that is no more than
// (8 k^2 + 6 k) u (|p| + |t|) along each axis.
struct Placement {
    Transform toScene;
    NormalTransform normals;
    double condition, inverseNorm;  // k, and the largest sum of a row of |W|

    explicit Placement(const Transform& m) : toScene(m), normals(m) {
        const double d = std::abs(determinant(m));
        // Rows of `normals` are W's columns, times the determinant.
        std::array<Vec3d, 3> inverse;  // rows of |W|
        for (int i = 0; i < 3; ++i)
            inverse[static_cast<std::size_t>(i)] =
                Vec3d{std::abs(normals.rows[0][i]), std::abs(normals.rows[1][i]),
                      std::abs(normals.rows[2][i])} /
                d;
        const auto sum = [](const Vec3d& v) { return v.x + v.y + v.z; };
        condition = inverseNorm = 0.0;
        for (int i = 0; i < 3; ++i) {
            inverseNorm = std::max(inverseNorm, sum(inverse[static_cast<std::size_t>(i)]));
            const Vec3d ofM = row(m, i);
            double ofBoth = 0.0;
            for (int k = 0; k < 3; ++k)
                ofBoth += std::abs(ofM[k]) * sum(inverse[static_cast<std::size_t>(k)]);
            condition = std::max(condition, ofBoth);
        }
    }

    // How far from where it is a ray meets the mesh, along any direction; scene units. farthest:
    // largest coordinate of where the ray is.
    double error(double farthest) const {
        constexpr double kSqrt3 = 1.7320508075688772;
        const double t =
            std::max({std::abs(toScene[3]), std::abs(toScene[7]), std::abs(toScene[11])});
        return kSqrt3 * (8 * condition * condition + 6 * condition) * 0x1p-24 * (farthest + t);
    }
    double errorInObject(double farthest) const { return error(farthest) * inverseNorm; }

    // Where it is larger, float's errors in its space would be seen: it is better flattened.
    static constexpr double kMostCondition = 16.0;
};

}  // namespace pm
