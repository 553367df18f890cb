// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cmath>

#include "integrator/shapes/normal_map.h"
#include "integrator/values/vec.h"

namespace pm {

// Edges of a triangle from its first corner, scene units, and what texture coordinates change by
// along them.
struct TexturedEdges {
    Vec3d e1, e2;
    Vec2f d1, d2;
};

// What heights over a surface, in scene units, change by along u and v.
struct HeightSlopes {
    double u = 0.0, v = 0.0;
};

// The normal that heights over a triangle turn a shading normal to: it leans away from where they
// grow, by their gradient along the surface (Blinn, "Simulation of Wrinkled Surfaces", 1978, in the
// form of Mikkelsen, "Surface Gradient-Based Bump Mapping Framework", 2020). Even heights, and
// texture coordinates without area, leave it as it is. On the side of the geometric normal; both
// unit.
inline Vec3f bumpedNormal(const Vec3f& shadingNormal, const Vec3f& geometricNormal,
                          const TexturedEdges& of, const HeightSlopes& slopes) {
    if (slopes.u == 0.0 && slopes.v == 0.0) return shadingNormal;
    const double area = static_cast<double>(of.d1.x) * static_cast<double>(of.d2.y) -
                        static_cast<double>(of.d2.x) * static_cast<double>(of.d1.y);
    if (area == 0.0) return shadingNormal;
    const auto along = [&](float a, float b) {
        return (of.e1 * static_cast<double>(a) - of.e2 * static_cast<double>(b)) / area;
    };
    const Vec3d u = along(of.d2.y, of.d1.y), v = along(-of.d2.x, -of.d1.x), n(shadingNormal);
    const Vec3d byU = cross(v, n), byV = cross(n, u);
    // Of u, v and the normal; below 0 where the texture is mirrored.
    const double volume = dot(u, byU);
    const Vec3d gradient = byU * slopes.u + byV * slopes.v;
    const Vec3d turned = n * std::abs(volume) - (volume < 0.0 ? -gradient : gradient);
    if (!(volume != 0.0 && lengthSquared(turned) > 0.0)) return shadingNormal;
    return aboveHorizon(Vec3f(normalize(turned)), geometricNormal);
}

}  // namespace pm
