// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Rays against triangles without a gap between neighbours.
// [1] Woop, Benthin, Wald, Watertight Ray/Triangle Intersection, JCGT 2(1), 2013.
#pragma once

#include <array>
#include <cmath>
#include <utility>

#include "integrator/values/vec.h"

namespace pm {

// A ray's own space [1]: its origin is 0 and it goes along the third axis. Corners are rounded to
// float across the ray, where products of theirs are exact in double: on which side of an edge the
// ray passes is then the same for both triangles that have it, and near a corner exactly one of
// those around it is met, or several at its very edges, never none.
class ShearedRay {
  public:
    // direction: not 0.
    ShearedRay(const Vec3f& origin, const Vec3f& direction)
        : m_origin(origin), m_direction(direction) {
        const Vec3d d = m_direction;
        m_z = std::abs(d.x) > std::abs(d.y) ? (std::abs(d.x) > std::abs(d.z) ? 0 : 2)
                                            : (std::abs(d.y) > std::abs(d.z) ? 1 : 2);
        m_x = (m_z + 1) % 3;
        m_y = (m_z + 2) % 3;
        m_scale = 1.0 / d[m_z];
        m_shearX = d[m_x] * m_scale;
        m_shearY = d[m_y] * m_scale;
        for (int axis = 0; axis < 3; ++axis) {
            // So that no product with it is 0 times infinity.
            constexpr double kLargest = 1e300;
            m_inverse[axis] = d[axis] == 0.0 ? kLargest : 1.0 / d[axis];
        }
    }

    // Whether the line meets a triangle, and how far from the origin, in units of the direction's
    // length; no edge-on one.
    bool meets(const std::array<Vec3f, 3>& corners, double& t) const {
        const Corner a = seen(corners[0]), b = seen(corners[1]), c = seen(corners[2]);
        const double u = c.x * b.y - c.y * b.x, v = a.x * c.y - a.y * c.x,
                     w = b.x * a.y - b.y * a.x;
        if ((u < 0 || v < 0 || w < 0) && (u > 0 || v > 0 || w > 0)) return false;
        const double sum = u + v + w;
        if (sum == 0.0) return false;
        t = (u * a.z + v * b.z + w * c.z) / sum;
        return true;
    }

    // Whether [tNear, tFar] of the line goes through a box; where it comes in.
    bool meetsBox(const Vec3f& lo, const Vec3f& hi, double tNear, double tFar, double& in) const {
        for (int axis = 0; axis < 3; ++axis) {
            double t0 = (static_cast<double>(lo[axis]) - m_origin[axis]) * m_inverse[axis],
                   t1 = (static_cast<double>(hi[axis]) - m_origin[axis]) * m_inverse[axis];
            if (t0 > t1) std::swap(t0, t1);
            // What double's roundings may take off.
            constexpr double kMore = 1e-14;
            tNear = std::fmax(tNear, t0 - kMore * std::abs(t0));
            tFar = std::fmin(tFar, t1 + kMore * std::abs(t1));
        }
        in = tNear;
        return tNear <= tFar;
    }

  private:
    // Across the ray rounded to float; z: the distance along it.
    struct Corner {
        double x, y, z;
    };
    Corner seen(const Vec3f& corner) const {
        const Vec3d p = Vec3d(corner) - m_origin;
        const double z = p[m_z];
        return {static_cast<double>(static_cast<float>(p[m_x] - m_shearX * z)),
                static_cast<double>(static_cast<float>(p[m_y] - m_shearY * z)), z * m_scale};
    }

    Vec3d m_origin, m_direction, m_inverse;
    double m_scale, m_shearX, m_shearY;
    int m_x, m_y, m_z;
};

}  // namespace pm
