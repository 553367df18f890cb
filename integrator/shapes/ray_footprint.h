// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cmath>

#include "integrator/values/ray.h"
#include "integrator/values/uv_footprint.h"
#include "integrator/values/vec.h"

namespace pm {

// What a ray stands for beside itself, as ray differentials: by how much its origin and its
// direction change from one pixel to the next, to the right and down. Source: Igehy, "Tracing Ray
// Differentials", 1999. Of a ray that leaves a surface by a wide lobe, a cone around it.
// Textures are looked up over what it covers where it meets them.
struct RayFootprint {
    struct Side {
        Vec3f origin, direction;
        Vec3f normal{};  // of the shading normal, at the surface that was met last
    };
    Side x{}, y{};
    // False: nothing is known, and textures are looked up at their finest level.
    bool isKnown = false;
    // It has left a surface or a light by many directions, of which it stands for some.
    bool isWide = false;

    // Around a ray. direction: unit. spread: the cone's width for each unit of the way, radians;
    // width: where it starts, scene units.
    static RayFootprint cone(const Vec3f& direction, float spread, float width = 0.0f);

    // Of the shorter side, where the ray starts or has met a surface; scene units.
    float width() const;

    // The origin's change becomes that of the place where the ray meets a surface. ray: of unit
    // direction; normal: the geometric one, unit.
    void arrive(const Ray& ray, const Vec3f& position, const Vec3f& normal);

    // Onwards from there, off a mirror or through a boundary. in: the ray's direction; normal: the
    // shading normal on the side that the ray came from; turned: whether it points into the
    // surface's front; eta: index on the far side over that on the near side.
    void reflect(const Vec3f& in, const Vec3f& normal, bool turned);
    void refract(const Vec3f& in, const Vec3f& normal, bool turned, float eta);
    // By any other lobe: a cone that spreads no less than the way before, from what that covers
    // here. pdfSolidAngle: of the new direction, sr^-1.
    void widen(const Vec3f& direction, float pdfSolidAngle);

    // The widest spread of a cone: what is blurred by so much has the same mean seen from a
    // surface, as far as a cosine can tell.
    static constexpr float kWidest = 0.1f;
};

}  // namespace pm
