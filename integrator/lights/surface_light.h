// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>

#include "integrator/lights/light_sample.h"
#include "integrator/shapes/shape.h"
#include "integrator/shapes/surface.h"
#include "integrator/values/rgb.h"
#include "integrator/values/vec.h"

namespace pm {

class Scene;

// A primitive of a shape that shines: what kinds of light that rays meet have in common.
struct SurfaceLight {
    std::uint32_t shape = 0;
    std::uint32_t primitive = 0;
    std::uint32_t material = 0;
    std::int32_t texture = -1;  // its number in Scene::m_lampTextures; none: shines evenly
    float area = 0.0f;          // scene units squared

    bool shinesEvenly() const { return texture < 0; }
};

// A point on a light: what a Surface tells of it.
struct LampPoint {
    Vec3f position;
    float offset;
    Vec3f normal;  // geometric

    LampPoint(const Vec3f& at, float byOffset, const Vec3f& geometricNormal)
        : position(at), offset(byOffset), normal(geometricNormal) {}
    explicit LampPoint(const Surface& surface)
        : LampPoint(surface.position, surface.offset, surface.geometricNormal) {}
};

// A segment between two points off their surfaces. The end stays clear of the light by its own
// offset, and by the rounding of the segment's length.
Ray shadowSegment(const Vec3f& from, const LampPoint& to);

// All of a sample towards a point on a light but its radiance. area: of the light, over the density
// of its points. False: the point faces away.
bool sampleLampPoint(const Surface& from, const LampPoint& point, float probability, float area,
                     LightSample& sample);

// What these lights ask of the scene that they belong to; it is the scene's folder that sees this
// one, so there are the answers (scene/shining_shapes.cpp). See Scene for what they are.
SphereShape sphereOf(const Scene& scene, const SurfaceLight& light);
Surface pointOnLight(const Scene& scene, const SurfaceLight& light, Vec2f u);
Surface pointOnLight(const Scene& scene, const SurfaceLight& light, Vec2f u, float& density);
Surface pointOnSphere(const Scene& scene, const SurfaceLight& light, const Vec3d& direction);
float densityOnLight(const Scene& scene, const SurfaceLight& light, const Surface& point);
Rgb frontRadiance(const Scene& scene, const Surface& point);

}  // namespace pm
