// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>

#include "integrator/lights/surface_light.h"
#include "integrator/sampling/warps.h"
#include "integrator/shapes/surface.h"
#include "integrator/values/vec.h"

namespace pm {

// All that a point on a triangle that shines evenly is found by, in one cache line: mesh, facet and
// light would be five or six, of ten thousand lamps none of them at hand. The scene's own
// coordinates.
struct alignas(64) LampTriangle {
    Vec3f vertices[3];
    Vec3f normal;                // geometric, unit, out of the front
    float reach = 0.0f;          // Scene::Facet::reach, scene units
    float area = 0.0f;           // scene units squared; 0: not such a triangle
    std::uint32_t material = 0;  // whose emission is the same all over it

    explicit operator bool() const { return area > 0.0f; }

    // The point that Scene::pointOnLight() finds, to the bit, uniform over the area.
    LampPoint point(Vec2f u) const {
        const Vec2f b = sampleTriangle(u);
        const Vec3d v0(vertices[0]), e1 = Vec3d(vertices[1]) - v0, e2 = Vec3d(vertices[2]) - v0;
        const Vec3f position(v0 + (e1 * static_cast<double>(b.x) + e2 * static_cast<double>(b.y)));
        return {position, surfaceOffset(position, reach), normal};
    }
};
static_assert(sizeof(LampTriangle) == 64);

}  // namespace pm
