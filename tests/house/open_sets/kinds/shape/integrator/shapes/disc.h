// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "integrator/shapes/roots.h"
#include "integrator/shapes/surface.h"
#include "integrator/values/box.h"
#include "integrator/values/transform.h"
#include "integrator/values/vec.h"

namespace pm {

class PlacedDisc;

// A flat disc in object space.
struct DiscShape {
    using Placed = PlacedDisc;
    static constexpr const char* kName = "disc";

    Vec3d centre, normal{0.0, 0.0, 1.0};
    double radius = 1.0;
};

// A disc where it stands; see CurvedShape. Its transform turns, moves and scales alike.
class PlacedDisc {
  public:
    PlacedDisc(const DiscShape& disc, const Transform& toWorld, const Vec3d& origin, bool,
               const std::string&)
        : m_centre(transformPoint(toWorld, disc.centre) - origin) {
        const Vec3d turned = transformPoint(toWorld, disc.centre + disc.normal) - origin - m_centre;
        m_normal = normalize(turned);
        m_radius = disc.radius * length(turned) / length(disc.normal);
    }

    Box3d bounds() const {
        const auto half = [&](double n) {
            return m_radius * std::sqrt(std::max(0.0, 1.0 - n * n));
        };
        const Vec3d reach{half(m_normal.x), half(m_normal.y), half(m_normal.z)};
        return {m_centre - reach, m_centre + reach};
    }
    double size() const { return 2 * m_radius; }
    double area() const { return std::numbers::pi * m_radius * m_radius; }
    RayRoots roots(const Vec3d& origin, const Vec3d& direction) const {
        RayRoots roots;
        const double across = dot(direction, m_normal);
        if (across == 0.0) return roots;
        const double t = dot(m_centre - origin, m_normal) / across;
        if (lengthSquared(origin + direction * t - m_centre) <= m_radius * m_radius) roots.add(t);
        return roots;
    }
    void surfaceNear(const Vec3d& point, Surface& surface) const {
        const Vec3d onPlane = point - m_normal * dot(point - m_centre, m_normal);
        surface.position = Vec3f(onPlane);
        surface.offset = 2.0f * surfaceOffset(surface.position, 0.0f);
        surface.geometricNormal = surface.shadingNormal = Vec3f(m_normal);
        surface.uv = {};
    }

  private:
    Vec3d m_centre, m_normal;
    double m_radius;
};

}  // namespace pm
