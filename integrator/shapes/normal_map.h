// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <algorithm>
#include <cmath>

#include "integrator/values/vec.h"

namespace pm {

// A channel of a normal map as a component: of 8 bits 0 is -1, 128 is exactly 0 and 255 is 1.
inline float decodedNormal(float channel) {
    return std::clamp((channel * 255.0f - 128.0f) / 127.0f, -1.0f, 1.0f);
}

// Edges of a triangle from its first corner, scene units, and what texture coordinates change by
// along them.
struct TexturedEdges {
    Vec3d e1, e2;
    Vec2f d1, d2;
};

// The normal that a map turns a shading normal to. mapped: its components along the tangent (where
// u grows), the bitangent (where v grows) and the normal. The frame is the shading normal's, with
// the triangle's tangent put at right angles to it and the bitangent's side as v has it, mirrored
// textures included (Mikkelsen, "Simulation of Wrinkled Surfaces Revisited", 2008, a triangle at a
// time). Where texture coordinates have no area, or the map says nothing, it is the normal itself.
// On the side of the geometric normal; both unit.
inline Vec3f mappedNormal(const Vec3f& shadingNormal, const Vec3f& geometricNormal,
                          const TexturedEdges& of, const Vec3f& mapped) {
    if (mapped.x == 0.0f && mapped.y == 0.0f) return shadingNormal;
    const double area = static_cast<double>(of.d1.x) * static_cast<double>(of.d2.y) -
                        static_cast<double>(of.d2.x) * static_cast<double>(of.d1.y);
    if (area == 0.0) return shadingNormal;
    const auto along = [&](float a, float b) {
        return (of.e1 * static_cast<double>(a) - of.e2 * static_cast<double>(b)) / area;
    };
    const Vec3d u = along(of.d2.y, of.d1.y), v = along(-of.d2.x, -of.d1.x), n(shadingNormal);
    const Vec3d flat = u - n * dot(u, n);
    if (!(lengthSquared(flat) > 0.0)) return shadingNormal;
    const Vec3d tangent = normalize(flat);
    Vec3d bitangent = cross(n, tangent);
    if (dot(bitangent, v) < 0.0) bitangent = -bitangent;
    const Vec3d turned = tangent * static_cast<double>(mapped.x) +
                         bitangent * static_cast<double>(mapped.y) +
                         n * static_cast<double>(mapped.z);
    if (!(lengthSquared(turned) > 0.0)) return shadingNormal;
    Vec3f normal(normalize(turned));
    // Beyond the horizon of its own surface a normal says nothing of its front.
    constexpr float kLeast = 1e-3f;
    const float above = dot(normal, geometricNormal);
    if (above < kLeast) normal = normalize(normal + geometricNormal * (kLeast - above));
    return normal;
}

}  // namespace pm
