// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cmath>
#include <cstdint>

#include "integrator/values/ray.h"
#include "integrator/values/uv_footprint.h"
#include "integrator/values/vec.h"

namespace pm {

inline constexpr std::int32_t kNoLight = -1;
inline constexpr std::int32_t kNoMedium = -1;

// A point on a surface of the scene, in the scene's own coordinates.
struct Surface {
    Vec3f position;
    // How far a ray must start off the surface along the geometric normal so that it can't meet the
    // surface it starts from: an error bound, scene units (see surfaceOffset).
    float offset = 0.0f;
    Vec3f geometricNormal;  // unit, out of the front
    Vec3f shadingNormal;    // unit, in the hemisphere of the geometric normal
    // Where u grows, of anisotropic materials: unit, at right angles to the shading normal; 0 where
    // the material is none or there are no texture coordinates.
    Vec3f tangent;
    Vec2f uv;
    UvFootprint footprint;  // of whoever looks at it; see RayFootprint
    std::uint32_t material = 0;
    std::uint32_t shape = 0;
    std::uint32_t primitive = 0;
    std::uint32_t instanceId = 0;
    std::int32_t light = kNoLight;  // the area light that this primitive is
    // Of glass: the far side of the same body is so close behind that no ray could start between.
    // Both are met as one.
    bool isPane = false;
    // Where it is looked for what is inside of what, see Scene::Media: the material of the medium
    // on the side that the ray came from, and of glass the index beyond over the one there (0: as
    // its own material and front say).
    std::int32_t medium = kNoMedium;
    float eta = 0.0f;
    float time = 0.0f;  // of the ray that met it
    // Where there is a tangent: whether the bitangent, where v grows, is minus the cross product of
    // shading normal and tangent.
    bool isTextureMirrored = false;
};

// Bound on the distance between a computed point on a triangle and where Embree's robust
// intersector may still see that triangle. u = 2^-24:
//   the point is exact in double and rounded to float:       u |p|_1 along any unit normal,
//   adding the offset rounds once more:                      u |p|_1,
//   the intersector translates the vertices to the origin and forms t from sums of three products:
//   about 5 roundings of terms as large as the farthest vertex's distance; 16 taken.
inline float surfaceOffset(const Vec3f& position, float farthestVertexDistance) {
    constexpr float u = 0x1p-24f;
    return 2.0f * u * (std::abs(position.x) + std::abs(position.y) + std::abs(position.z)) +
           16.0f * u * farthestVertexDistance;
}

// Where a ray that leaves `surface` along `direction` starts.
inline Vec3f rayOrigin(const Surface& surface, const Vec3f& direction) {
    const float side = dot(direction, surface.geometricNormal) >= 0.0f ? 1.0f : -1.0f;
    return surface.position + surface.geometricNormal * (side * surface.offset);
}

inline Ray rayFrom(const Surface& surface, const Vec3f& direction) {
    Ray ray{rayOrigin(surface, direction), direction};
    ray.time = surface.time;
    return ray;
}

// The point beside a hit, on its surface's plane, over which the ray that led there passed at this
// height: what is lifted by so much from there is on the ray's side of all that stands close by, as
// a leaning wall. ray: of unit direction; normal: unit, on its side; height: scene units. At
// grazing angles the point is moved by no more than eight heights, and never by more than half of
// the way.
inline Vec3f pointUnderRay(const Vec3f& position, const Ray& ray, const Vec3f& normal,
                           float height) {
    constexpr float kLeastCosine = 0.125f;
    const float cosine = -dot(ray.direction, normal);
    const float back =
        std::fmin(height / std::fmax(cosine, kLeastCosine), 0.5f * length(position - ray.origin));
    return position - (ray.direction + normal * cosine) * back;
}

// A ray onwards from such a point, on the normal's side. It starts at that height, and then by half
// of it behind: a wall so close that roundings lose it at a ray's beginning is met all the same.
inline Ray rayOnwards(const Vec3f& position, const Vec3f& normal, const Vec3f& direction,
                      float height, float time) {
    Ray ray{position + (normal - direction * 0.5f) * height, direction};
    ray.time = time;
    return ray;
}

}  // namespace pm
