// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/scene/light_sampler.h"

#include <algorithm>
#include <cmath>

#include "integrator/sampling/warps.h"

namespace pm {

namespace {

// Share of the choices made evenly rather than by power: a weak lamp beside a thousand bright far
// ones still gets its photons.
constexpr double kEvenShare = 0.1;

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

}  // namespace

LightSampler::LightSampler(const Scene& scene) : m_scene(scene) {
    const auto& lights = scene.lights();
    double totalPower = 0;
    for (const Light& light : lights) totalPower += light.powerMean;
    if (lights.empty() || !(totalPower > 0)) return;
    const double even = kEvenShare / static_cast<double>(lights.size());
    // A light is taken with the probability that the rounded sums leave it, whatever was meant:
    // sums in steps of the random numbers, 2^-24. One whose share is less than a step could get
    // none, so each gets at least one; with 2^24 lights and more that would be all there is.
    constexpr double kSteps = 0x1p24;
    const double atLeast = 1.0 / kSteps;
    const double scale = 1.0 - atLeast * static_cast<double>(lights.size());
    double sum = 0, before = 0;
    for (const Light& light : lights) {
        sum += atLeast + scale * (even + (1 - kEvenShare) * light.powerMean / totalPower);
        const double rounded =
            &light == &lights.back() ? 1.0 : std::min(1.0, std::round(sum * kSteps) / kSteps);
        m_probabilities.push_back(static_cast<float>(rounded - before));
        m_cumulative.push_back(static_cast<float>(rounded));
        before = rounded;
    }
}

std::uint32_t LightSampler::choose(float u, float& probability) const {
    const auto it = std::upper_bound(m_cumulative.begin(), m_cumulative.end(), u);
    const auto index = static_cast<std::size_t>(std::min<std::ptrdiff_t>(
        it - m_cumulative.begin(), static_cast<std::ptrdiff_t>(m_cumulative.size()) - 1));
    probability = m_probabilities[index];
    return static_cast<std::uint32_t>(index);
}

Rgb LightSampler::emittedRadiance(const Surface& surface, const Vec3f& direction) const {
    if (surface.light == kNoLight || dot(direction, surface.geometricNormal) <= 0.0f) return {};
    const MaterialDescription& material = m_scene.material(surface.material);
    if (material.emissionTexture == kNoTexture) return material.emission;
    const Texel texel = m_scene.textures()->lookUp(material.emissionTexture, surface.uv, 0.0f);
    return material.emission * Rgb(texel.r, texel.g, texel.b);
}

bool LightSampler::sample(const Surface& surface, float uLight, Vec2f uPoint,
                          LightSample& sample) const {
    if (empty()) return false;
    float probability;
    const Light& light = m_scene.lights()[choose(uLight, probability)];
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
    const float probability = m_probabilities[index];
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

// From outside the scene only the cone that holds all of it is worth a photon; the rest of the
// light's flux would escape.
bool LightSampler::emitFromPoint(const Light& light, float probability, Vec2f u,
                                 EmittedPhoton& photon) const {
    const double r2 = m_scene.radius() * m_scene.radius() * 1.0001;
    const double d2 = lengthSquared(light.position);
    const bool outside = d2 > r2;
    const float oneMinusCos = outside ? oneMinusCosThetaMax(r2, d2) : 2.0f;
    const Frame frame(outside ? Vec3f(-light.position / std::sqrt(d2)) : Vec3f{0.0f, 0.0f, 1.0f});
    photon.ray = {Vec3f(light.position),
                  normalize(frame.toWorld(sampleUniformCone(u, oneMinusCos)))};
    photon.flux = light.intensity * (2.0f * kPi * oneMinusCos / probability);
    return true;
}

bool LightSampler::emit(float uLight, Vec2f uPoint, Vec2f uDirection, EmittedPhoton& photon) const {
    if (empty()) return false;
    float probability;
    const Light& light = m_scene.lights()[choose(uLight, probability)];
    if (light.kind == Light::Kind::kPoint) {
        return emitFromPoint(light, probability, uDirection, photon);
    }
    const Surface point = m_scene.pointOnLight(light, uPoint);
    const Frame frame(point.geometricNormal);
    const Vec3f direction = frame.toWorld(sampleCosineHemisphere(uDirection));
    // Uniform area density 1/A and direction density cos/pi leave the radiance times pi A.
    const MaterialDescription& material = m_scene.material(light.material);
    Rgb radiance = material.emission;
    if (material.emissionTexture != kNoTexture) {
        const Texel texel = m_scene.textures()->lookUp(material.emissionTexture, point.uv, 0.0f);
        radiance *= Rgb(texel.r, texel.g, texel.b);
    }
    photon.ray = {rayOrigin(point, point.geometricNormal), direction};
    photon.flux = radiance * (kPi * light.area / probability);
    return !isBlack(photon.flux);
}

}  // namespace pm
