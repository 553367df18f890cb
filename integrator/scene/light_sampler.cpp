// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/scene/light_sampler.h"

#include <algorithm>
#include <cmath>

#include "integrator/sampling/warps.h"

namespace pm {

namespace {

// A segment between two points off their surfaces. The end stays clear of the light by its own
// offset, and by the rounding of the segment's length.
Ray shadowSegment(const Vec3f& from, const Vec3f& to, const Vec3f& lightNormal, float lightOffset) {
    const Vec3f straight = to - from;
    const float reach = std::sqrt(lengthSquared(straight));
    const Vec3f end = to + lightNormal * (lightOffset + 4.0f * 0x1p-24f * reach);
    return {from, end - from, 1.0f - 8.0f * 0x1p-24f};
}

// 1 - cos of the half angle under which a sphere is seen from squared distance d2, d2 > r2.
float oneMinusCosThetaMax(double r2, double d2) {
    const double sin2 = r2 / d2;
    return static_cast<float>(sin2 / (1.0 + std::sqrt(1.0 - sin2)));
}

LightChoice choiceByPower(const std::vector<Light>& lights) {
    std::vector<double> powers;
    for (const Light& light : lights) powers.push_back(light.powerMean);
    return LightChoice(powers);
}

}  // namespace

LightSampler::LightSampler(const Scene& scene)
    : m_scene(scene), m_choice(choiceByPower(scene.lights())) {}

Rgb LightSampler::emittedRadiance(const Surface& surface, const Vec3f& direction) const {
    if (surface.light == kNoLight || dot(direction, surface.geometricNormal) <= 0.0f) return {};
    return frontRadiance(surface);
}

Rgb LightSampler::frontRadiance(const Surface& surface) const {
    const MaterialDescription& material = m_scene.material(surface.material);
    if (material.emissionTexture == kNoTexture) return material.emission;
    const Texel texel = m_scene.textures()->lookUp(material.emissionTexture, surface.uv, 0.0f);
    return material.emission * Rgb(texel.r, texel.g, texel.b);
}

bool LightSampler::sample(const Surface& surface, Vec2f uPoint, LightSample& sample) const {
    if (empty()) return false;
    float probability;
    const Light& light = m_scene.lights()[m_choice.chooseAndStretch(uPoint.x, probability)];
    switch (light.kind) {
        case Light::Kind::kTriangle:
            return sampleTriangle(surface, light, probability, uPoint, sample);
        case Light::Kind::kSphere:
            return sampleSphere(surface, light, probability, uPoint, sample);
        case Light::Kind::kPoint:
            return samplePoint(surface, light, probability, sample);
    }
    return false;
}

bool LightSampler::sampleTriangle(const Surface& surface, const Light& light, float probability,
                                  Vec2f u, LightSample& sample) const {
    const Surface point = m_scene.pointOnLight(light, u);
    const Vec3f toLight = point.position - surface.position;
    const float d2 = lengthSquared(toLight);
    if (!(d2 > 0.0f)) return false;
    sample.direction = toLight / std::sqrt(d2);
    const float cosine = -dot(sample.direction, point.geometricNormal);
    if (!(cosine > 0.0f)) return false;
    sample.radiance = emittedRadiance(point, -sample.direction);
    sample.pdfSolidAngle = probability * d2 / (light.area * cosine);
    sample.isPoint = false;
    sample.shadowRay = shadowSegment(rayOrigin(surface, sample.direction), point.position,
                                     point.geometricNormal, point.offset);
    return true;
}

// Uniform over the solid angle that the sphere fills. Source: Shirley & Wang 1994.
bool LightSampler::sampleSphere(const Surface& surface, const Light& light, float probability,
                                Vec2f u, LightSample& sample) const {
    const SphereShape sphere = m_scene.sphere(light.shape);
    const Vec3d toCentre = sphere.centre - Vec3d(surface.position);
    const double d2 = lengthSquared(toCentre), r2 = sphere.radius * sphere.radius;
    if (!(d2 > r2 * (1 + 1e-6))) return false;  // inside: the front looks away
    const float oneMinusCos = oneMinusCosThetaMax(r2, d2);
    const Frame frame(Vec3f(toCentre / std::sqrt(d2)));
    sample.direction = frame.toWorld(sampleUniformCone(u, oneMinusCos));
    sample.direction = normalize(sample.direction);
    const Vec3d direction(sample.direction);
    double t =
        intersectSphere(Vec3d(surface.position), direction, 1e300, sphere.centre, sphere.radius);
    if (t < 0) t = dot(toCentre, direction);  // grazing, lost to rounding: the nearest point
    const Vec3d onSphere = Vec3d(surface.position) + direction * t;
    const Vec3f normal(normalize(onSphere - sphere.centre));
    const MaterialDescription& material = m_scene.material(light.material);
    sample.radiance = material.emission;
    sample.pdfSolidAngle = probability / (2.0f * kPi * oneMinusCos);
    sample.isPoint = false;
    const Vec3f position(onSphere);
    sample.shadowRay = shadowSegment(rayOrigin(surface, sample.direction), position, normal,
                                     2.0f * surfaceOffset(position, 0.0f));
    return true;
}

bool LightSampler::samplePoint(const Surface& surface, const Light& light, float probability,
                               LightSample& sample) const {
    const Vec3d toLight = light.position - Vec3d(surface.position);
    const double d2 = lengthSquared(toLight);
    if (!(d2 > 0)) return false;
    sample.direction = Vec3f(toLight / std::sqrt(d2));
    sample.radiance = light.intensity * static_cast<float>(1 / d2);
    sample.pdfSolidAngle = probability;
    sample.isPoint = true;
    const Vec3f origin = rayOrigin(surface, sample.direction);
    sample.shadowRay = {origin, Vec3f(light.position - Vec3d(origin)), 1.0f};
    return true;
}

float LightSampler::pdfSolidAngle(const Surface& from, const Vec3f& direction,
                                  const Surface& onLight) const {
    const auto index = static_cast<std::size_t>(onLight.light);
    const Light& light = m_scene.lights()[index];
    const float probability = m_choice.probability(index);
    if (light.kind == Light::Kind::kSphere) {
        const SphereShape sphere = m_scene.sphere(light.shape);
        const double d2 = lengthSquared(sphere.centre - Vec3d(from.position));
        const double r2 = sphere.radius * sphere.radius;
        return d2 > r2 * (1 + 1e-6) ? probability / (2.0f * kPi * oneMinusCosThetaMax(r2, d2))
                                    : 0.0f;
    }
    const float cosine = -dot(direction, onLight.geometricNormal);
    if (!(cosine > 0.0f)) return 0.0f;
    return probability * lengthSquared(onLight.position - from.position) / (light.area * cosine);
}

void LightSampler::pointLightCone(const Light& light, Vec3f& axis, float& oneMinusCos) const {
    const double r2 = m_scene.radius() * m_scene.radius() * 1.0001;
    const double d2 = lengthSquared(light.position);
    const bool outside = d2 > r2;
    oneMinusCos = outside ? oneMinusCosThetaMax(r2, d2) : 2.0f;
    axis = outside ? Vec3f(-light.position / std::sqrt(d2)) : Vec3f{0.0f, 0.0f, 1.0f};
}

bool LightSampler::emitFromPoint(const Light& light, float probability, Vec2f u,
                                 EmittedPhoton& photon) const {
    Vec3f axis;
    float oneMinusCos;
    pointLightCone(light, axis, oneMinusCos);
    photon.ray = {Vec3f(light.position),
                  normalize(Frame(axis).toWorld(sampleUniformCone(u, oneMinusCos)))};
    photon.flux = light.intensity * (2.0f * kPi * oneMinusCos / probability);
    return true;
}

bool LightSampler::emit(float uLight, Vec2f uPoint, Vec2f uDirection, EmittedPhoton& photon) const {
    if (empty()) return false;
    float probability;
    const Light& light = m_scene.lights()[m_choice.choose(uLight, probability)];
    if (light.kind == Light::Kind::kPoint) {
        return emitFromPoint(light, probability, uDirection, photon);
    }
    const Surface point = m_scene.pointOnLight(light, uPoint);
    const Frame frame(point.geometricNormal);
    const Vec3f direction = frame.toWorld(sampleCosineHemisphere(uDirection));
    photon.ray = {rayOrigin(point, point.geometricNormal), direction};
    // Uniform area density 1/A and direction density cos/pi leave the radiance times pi A.
    photon.flux = frontRadiance(point) * (kPi * light.area / probability);
    return !isBlack(photon.flux);
}

}  // namespace pm
