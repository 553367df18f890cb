// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>
#include <cstddef>

#include "integrator/values/vec.h"

namespace pm {

// Object to world, 3 x 4, row-major: p' = M[:, 0:3] p + M[:, 3].
using Transform = std::array<double, 12>;
inline constexpr Transform kIdentityTransform = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};

inline Vec3d transformPoint(const Transform& m, const Vec3d& p) {
    return {m[0] * p.x + m[1] * p.y + m[2] * p.z + m[3],
            m[4] * p.x + m[5] * p.y + m[6] * p.z + m[7],
            m[8] * p.x + m[9] * p.y + m[10] * p.z + m[11]};
}

inline Vec3d row(const Transform& m, int i) {
    const auto k = static_cast<std::size_t>(4 * i);
    return {m[k], m[k + 1], m[k + 2]};
}

inline double determinant(const Transform& m) {
    return dot(row(m, 0), cross(row(m, 1), row(m, 2)));
}

}  // namespace pm
