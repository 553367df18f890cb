// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "integrator/values/vec.h"

namespace pm {

// Finds the few triangles of a scene beside which all else is small: a ground, say, that reaches to
// the horizon. Float roundings of such a triangle are as large as what stands on it.
//
// All triangles and spheres are told twice, in the same order: once to learn which are the largest,
// once for where the others lie.
class HugeTriangles {
  public:
    // No more are looked for: of a finer mesh no triangle is huge.
    static constexpr std::size_t kMost = 4096;
    // Huge is what is so many times as long as all that is smaller, together, is wide. Rays start
    // 1e-6 of a triangle's length off it: a four-thousandth of the rest's width, then.
    static constexpr double kTimes = 256;

    // size: the longest edge, or a sphere's diameter; scene units.
    void addSize(double size);
    void addBox(double size, const Vec3d& lo, const Vec3d& hi);

    // Triangles that are longer are huge; infinity: none is. All must have been told twice.
    double mostNotHuge() const;

  private:
    struct Large {
        double size;
        Vec3d lo, hi;
    };

    std::vector<double> m_largest;  // a heap, the least on top
    std::vector<Large> m_large;
    Vec3d m_lo{1e300}, m_hi{-1e300};  // of what is not among the largest
};

}  // namespace pm
