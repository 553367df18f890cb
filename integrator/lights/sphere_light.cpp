// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/lights/sphere_light.h"

#include <cmath>

#include "integrator/sampling/warps.h"
#include "integrator/shapes/sphere.h"

namespace pm {

namespace {

// Of a textured sphere's samples: those that go by the texture and not by how it is seen.
constexpr float kTextureShare = 0.5f;

// False: from inside, or next to it, the front looks away.
bool isSeen(double d2, double r2) {
    return d2 > r2 * (1 + 1e-6);
}

}  // namespace

bool SphereLight::sample(const Scene& scene, const Surface& from, Vec2f u, float probability,
                         LightSample& sample) const {
    if (!shinesEvenly()) {
        const bool byTexture = u.x < kTextureShare;
        u.x = byTexture ? u.x / kTextureShare : (u.x - kTextureShare) / (1.0f - kTextureShare);
        if (byTexture) return sampleByTexture(scene, from, u, probability, sample);
    }
    const SphereShape sphere = sphereOf(scene, *this);
    const Vec3d toCentre = sphere.centre - Vec3d(from.position);
    const double d2 = lengthSquared(toCentre), r2 = sphere.radius * sphere.radius;
    if (!isSeen(d2, r2)) return false;
    const float oneMinusCos = oneMinusCosOfSphere(r2, d2);
    const Frame frame(Vec3f(toCentre / std::sqrt(d2)));
    sample.direction = frame.toWorld(sampleUniformCone(u, oneMinusCos));
    sample.direction = normalize(sample.direction);
    const Vec3d direction(sample.direction);
    double t =
        intersectSphere(Vec3d(from.position), direction, 1e300, sphere.centre, sphere.radius);
    if (t < 0) t = dot(toCentre, direction);  // grazing, lost to rounding: the nearest point
    const Surface point =
        pointOnSphere(scene, *this, Vec3d(from.position) + direction * t - sphere.centre);
    sample.radiance = frontRadiance(scene, point);
    sample.pdfSolidAngle = probability / (2.0f * kPi * oneMinusCos);
    if (!shinesEvenly())
        sample.pdfSolidAngle = probability * pdfOfTextured(scene, from, sample.direction, point);
    sample.isPoint = false;
    sample.shadowRay = shadowSegment(rayOrigin(from, sample.direction), LampPoint(point));
    return true;
}

bool SphereLight::sampleByTexture(const Scene& scene, const Surface& from, Vec2f u,
                                  float probability, LightSample& sample) const {
    float density;
    const Surface point = pointOnLight(scene, *this, u, density);
    if (!sampleLampPoint(from, LampPoint(point), probability, area / density, sample)) return false;
    sample.radiance = frontRadiance(scene, point);
    sample.pdfSolidAngle = probability * pdfOfTextured(scene, from, sample.direction, point);
    return true;
}

float SphereLight::pdfOfTextured(const Scene& scene, const Surface& from, const Vec3f& direction,
                                 const Surface& point) const {
    const SphereShape sphere = sphereOf(scene, *this);
    const double d2 = lengthSquared(sphere.centre - Vec3d(from.position));
    const double r2 = sphere.radius * sphere.radius;
    if (!isSeen(d2, r2)) return 0.0f;
    const float even = 1.0f / (2.0f * kPi * oneMinusCosOfSphere(r2, d2));
    const float cosine = -dot(direction, point.geometricNormal);
    if (!(cosine > 0.0f)) return (1.0f - kTextureShare) * even;
    return (1.0f - kTextureShare) * even + kTextureShare * densityOnLight(scene, *this, point) *
                                               lengthSquared(point.position - from.position) /
                                               (area * cosine);
}

float SphereLight::pdfSolidAngle(const Scene& scene, const Surface& from, const Vec3f& direction,
                                 const Surface& onLight, float probability) const {
    if (!shinesEvenly()) return probability * pdfOfTextured(scene, from, direction, onLight);
    const SphereShape sphere = sphereOf(scene, *this);
    const double d2 = lengthSquared(sphere.centre - Vec3d(from.position));
    const double r2 = sphere.radius * sphere.radius;
    return isSeen(d2, r2) ? probability / (2.0f * kPi * oneMinusCosOfSphere(r2, d2)) : 0.0f;
}

LightExtent SphereLight::extent(const Scene& scene) const {
    const SphereShape sphere = sphereOf(scene, *this);
    const Vec3d radius(sphere.radius);
    return {sphere.centre - radius, sphere.centre + radius, {}, true};
}

LightBall SphereLight::ball(const Scene& scene) const {
    const SphereShape sphere = sphereOf(scene, *this);
    return {Vec3f(sphere.centre), static_cast<float>(sphere.radius)};
}

}  // namespace pm
