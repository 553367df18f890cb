// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <algorithm>
#include <cmath>

#include "integrator/values/vec.h"

namespace pm {

// The shadow of a box in parallel light: what it throws on a plane across the light. The sides that
// the light meets cover it exactly once, so a point on one of them, each as often as its area seen
// along the light, is even over the shadow.
// Positions are relative to the box's centre.
class BoxShadow {
  public:
    // halfSize: of the box, along the axes, >= 0. direction: unit, the way that the light travels.
    BoxShadow(const Vec3d& halfSize, const Vec3d& direction)
        : m_halfSize(halfSize),
          m_direction(direction),
          m_sides{std::abs(direction.x) * 4 * halfSize.y * halfSize.z,
                  std::abs(direction.y) * 4 * halfSize.z * halfSize.x,
                  std::abs(direction.z) * 4 * halfSize.x * halfSize.y} {}

    // Scene units squared.
    double area() const { return m_sides.x + m_sides.y + m_sides.z; }

    // Where light enters the box, with density 1/area() across the light. The area must be > 0.
    Vec3d sample(Vec2f u) const {
        double chosen = static_cast<double>(u.x) * area();
        int side = 0;
        while (side < 2 && chosen >= m_sides[side]) chosen -= m_sides[side++];
        const double x = m_sides[side] > 0 ? std::clamp(chosen / m_sides[side], 0.0, 1.0) : 0.5;
        const int a = (side + 1) % 3, b = (side + 2) % 3;
        Vec3d point;
        point[side] = m_direction[side] > 0 ? -m_halfSize[side] : m_halfSize[side];
        point[a] = (2 * x - 1) * m_halfSize[a];
        point[b] = (2 * static_cast<double>(u.y) - 1) * m_halfSize[b];
        return point;
    }

    // Whether light through a point meets the box.
    bool holds(const Vec3d& point) const {
        double begin = -1e300, end = 1e300;
        for (int axis = 0; axis < 3; ++axis) {
            const double d = m_direction[axis], h = m_halfSize[axis];
            if (d == 0) {
                if (std::abs(point[axis]) > h) return false;
                continue;
            }
            const double t0 = (-h - point[axis]) / d, t1 = (h - point[axis]) / d;
            begin = std::max(begin, std::min(t0, t1));
            end = std::min(end, std::max(t0, t1));
        }
        return begin <= end;
    }

  private:
    Vec3d m_halfSize, m_direction, m_sides;
};

// Area of the scene's box as parallel light sees it; at least something, so that the light of a
// flat scene seen from its edge still has some power.
inline double crossSection(const Vec3d& halfSize, const Vec3d& direction) {
    return std::max(BoxShadow(halfSize, direction).area(), 1e-3 * lengthSquared(halfSize));
}

}  // namespace pm
