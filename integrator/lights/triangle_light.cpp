// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/lights/triangle_light.h"

#include <algorithm>
#include <array>
#include <limits>

namespace pm {

namespace {

// Random numbers for which a point of a triangle is a corner of it.
constexpr std::array<Vec2f, 3> kCorners = {Vec2f{0, 0}, Vec2f{1, 0}, Vec2f{1, 1}};

}  // namespace

bool TriangleLight::sample(const Scene& scene, const Surface& from, Vec2f u, float probability,
                           LightSample& sample) const {
    float density;
    const Surface point = pointOnLight(scene, *this, u, density);
    sample.radiance = frontRadiance(scene, point);
    return sampleLampPoint(from, LampPoint(point), probability, area / density, sample);
}

float TriangleLight::pdfSolidAngle(const Scene& scene, const Surface& from, const Vec3f& direction,
                                   const Surface& onLight, float probability) const {
    const float cosine = -dot(direction, onLight.geometricNormal);
    if (!(cosine > 0.0f)) return 0.0f;
    return probability * lengthSquared(onLight.position - from.position) / (area * cosine) *
           densityOnLight(scene, *this, onLight);
}

LightExtent TriangleLight::extent(const Scene& scene) const {
    LightExtent extent;
    extent.lo = Vec3d(std::numeric_limits<double>::max());
    extent.hi = -extent.lo;
    for (const Vec2f& corner : kCorners) {
        const Surface surface = pointOnLight(scene, *this, corner);
        const Vec3d p(surface.position);
        for (int axis = 0; axis < 3; ++axis) {
            extent.lo[axis] = std::min(extent.lo[axis], p[axis]);
            extent.hi[axis] = std::max(extent.hi[axis], p[axis]);
        }
        extent.axis = surface.geometricNormal;
    }
    return extent;
}

LightBall TriangleLight::ball(const Scene& scene) const {
    std::array<Vec3f, 3> corners;
    for (std::size_t i = 0; i < 3; ++i)
        corners[i] = pointOnLight(scene, *this, kCorners[i]).position;
    LightBall ball{(corners[0] + corners[1] + corners[2]) * (1.0f / 3.0f), 0.0f};
    for (const Vec3f& corner : corners)
        ball.radius = std::max(ball.radius, length(corner - ball.centre));
    return ball;
}

}  // namespace pm
