// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include "integrator/materials/bsdf.h"
#include "integrator/scene/scene.h"
#include "integrator/shapes/surface.h"

namespace pm {

// Where light is scattered inside of a medium.
struct MediumScattering {
    HenyeyGreenstein phase;
    Rgb albedo;  // of what is lost on the way, the share that is scattered
};

// A place of a path: on a surface, or in a medium, where `surface` is the place alone: its offset
// is 0, its normal points back along the ray.
struct Vertex {
    Surface surface;
    const MediumScattering* medium = nullptr;  // null: on a surface

    // All lobes by which light goes on. out: back along the ray.
    Bsdf closure(const Scene& scene, const Vec3f& out, Transport transport,
                 const Rgb& carried) const {
        return medium ? Bsdf(medium->phase, medium->albedo, out, transport, carried)
                      : Bsdf(scene.materials(), surface, out, transport, carried);
    }
};

// In a medium, on the way of a ray.
inline Vertex vertexInMedium(const MediumScattering& medium, const Ray& ray, float distance) {
    Vertex vertex;
    vertex.surface.position = ray.origin + ray.direction * distance;
    vertex.surface.geometricNormal = vertex.surface.shadingNormal = -ray.direction;
    vertex.surface.time = ray.time;
    vertex.medium = &medium;
    return vertex;
}

}  // namespace pm
