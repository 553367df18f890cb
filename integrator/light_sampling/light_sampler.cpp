// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/light_sampling/light_sampler.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "integrator/sampling/sampler.h"
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

LightChoice choiceByPower(std::span<const Light> lights) {
    std::vector<double> powers;
    for (const Light& light : lights) powers.push_back(light.powerMean);
    return LightChoice(powers);
}

// Bounds of the share of choices that lights infinitely far have beside many others.
constexpr float kLeastFarShare = 0.1f, kMostFarShare = 0.5f;

double powerOf(std::span<const Light> lights) {
    double power = 0;
    for (const Light& light : lights) power += light.powerMean;
    return power;
}

// Of a textured sphere's samples: those that go by the texture and not by how it is seen.
constexpr float kTextureShare = 0.5f;

// Choices of guided lights that are made side by side.
constexpr std::size_t kMostAtOnce = 16;

}  // namespace

LightSampler::LightSampler(const Scene& scene, LightChoice choice)
    : m_scene(scene), m_choice(std::move(choice)) {}

LightSampler LightSampler::forPhotons(const Scene& scene) {
    return {scene, choiceByPower(scene.lights())};
}

LightSampler::LightSampler(const Scene& scene, const CancelCheck& cancel)
    : LightSampler(scene, choiceByPower(scene.lights())) {
    if (empty() || scene.nearLights().size() <= kFewLights) return;
    m_tree = std::make_unique<LightTree>(scene, cancel);
    m_farChoice = choiceByPower(scene.farLights());
    if (m_farChoice.empty()) return;
    const double far = powerOf(scene.farLights());
    m_farShare = std::clamp(static_cast<float>(far / (far + powerOf(scene.nearLights()))),
                            kLeastFarShare, kMostFarShare);
}

Receiver LightSampler::receiverAt(const Surface& surface, const Vec3f& side) {
    const bool front = dot(side, surface.geometricNormal) >= 0.0f;
    return {surface.position, front ? surface.shadingNormal : -surface.shadingNormal};
}

void LightSampler::choose(const Surface& surface, const Vec3f& side,
                          std::span<ChosenLight> chosen) const {
    if (!isGuided()) {
        for (ChosenLight& one : chosen)
            one.light = m_choice.chooseAndStretch(one.u.x, one.probability);
        return;
    }
    const Receiver receiver = receiverAt(surface, side);
    if (chosen.size() == 1) {
        chooseGuided<1>(receiver, chosen);
        return;
    }
    while (!chosen.empty()) {
        const std::size_t count = std::min(chosen.size(), kMostAtOnce);
        chooseGuided<kMostAtOnce>(receiver, chosen.first(count));
        chosen = chosen.subspan(count);
    }
}

template <std::size_t kMost>
void LightSampler::chooseGuided(const Receiver& receiver, std::span<ChosenLight> chosen) const {
    std::array<LightDescent, kMost> descents;
    std::array<ChosenLight*, kMost> chosenNear;
    std::size_t near = 0;
    const auto farShare = static_cast<double>(m_farShare);
    for (ChosenLight& one : chosen) {
        const double x = refined(one.u);
        if (x < farShare) {
            one.u.x = toBelowOne(x / farShare);
            one.light = static_cast<std::uint32_t>(m_scene.nearLights().size()) +
                        m_farChoice.chooseAndStretch(one.u.x, one.probability);
            one.probability *= m_farShare;
        } else {
            descents[near] = {(x - farShare) / (1.0 - farShare), LightTree::kRoot,
                              1.0f - m_farShare};
            chosenNear[near++] = &one;
        }
    }
    const std::span<LightDescent> ready(descents.data(), near);
    if (m_guide) {
        m_guide->choose(receiver, ready);
    } else {
        m_tree->choose(receiver, ready);
    }
    for (std::size_t i = 0; i < near; ++i) {
        ChosenLight& one = *chosenNear[i];
        one.u.x = toBelowOne(descents[i].u);
        one.light = descents[i].node;
        one.probability = descents[i].probability;
        // Of one alone there is no time to fetch anything in.
        if (kMost > 1) __builtin_prefetch(&m_scene.lampTriangle(one.light));
    }
}

float LightSampler::probability(const Surface& surface, const Vec3f& side,
                                std::uint32_t light) const {
    if (!isGuided()) return m_choice.probability(light);
    const std::size_t near = m_scene.nearLights().size();
    if (light >= near) return m_farShare * m_farChoice.probability(light - near);
    const Receiver receiver = receiverAt(surface, side);
    return (1.0f - m_farShare) * (m_guide ? m_guide->probability(receiver, light)
                                          : m_tree->probability(LightTree::kRoot, receiver, light));
}

std::uint64_t LightSampler::memoryBytes() const {
    return (m_tree ? m_tree->memoryBytes() : 0) + (m_guide ? m_guide->memoryBytes() : 0) +
           (m_skyGuide ? m_skyGuide->memoryBytes() : 0);
}

Rgb LightSampler::emittedRadiance(const Surface& surface, const Vec3f& direction) const {
    if (surface.light == kNoLight || dot(direction, surface.geometricNormal) <= 0.0f) return {};
    return frontRadiance(surface);
}

Rgb LightSampler::frontRadiance(const Surface& surface) const {
    return m_scene.emission(surface.material, surface.uv);
}

bool LightSampler::sample(const Surface& surface, const Vec3f& side, Vec2f uPoint,
                          LightSample& sample) const {
    if (empty()) return false;
    ChosenLight chosen{uPoint};
    choose(surface, side, {&chosen, 1});
    return this->sample(chosen, surface, sample);
}

bool LightSampler::sample(const ChosenLight& chosen, const Surface& surface,
                          LightSample& sample) const {
    const float probability = chosen.probability;
    const Vec2f uPoint = chosen.u;
    if (const LampTriangle& lamp = m_scene.lampTriangle(chosen.light)) {
        sample.radiance = m_scene.material(lamp.material).emission;
        return sampleTriangle(surface, lamp.point(uPoint), probability, lamp.area, sample);
    }
    const Light& light = m_scene.lights()[chosen.light];
    switch (light.kind) {
        case Light::Kind::kTriangle: {
            float density;
            const Surface point = m_scene.pointOnLight(light, uPoint, density);
            sample.radiance = frontRadiance(point);
            return sampleTriangle(surface, {point.position, point.offset, point.geometricNormal},
                                  probability, light.area / density, sample);
        }
        case Light::Kind::kSphere:
            return sampleSphere(surface, light, probability, uPoint, sample);
        case Light::Kind::kPoint:
        case Light::Kind::kSpot:
            return samplePoint(surface, light, probability, sample);
        case Light::Kind::kDirectional:
        case Light::Kind::kEnvironment:
            return sampleFar(surface, light, probability, uPoint, sample);
    }
    return false;
}

// All of a sample but its radiance. area: of the triangle, over the density of its points.
bool LightSampler::sampleTriangle(const Surface& surface, const LampPoint& point, float probability,
                                  float area, LightSample& sample) const {
    const Vec3f toLight = point.position - surface.position;
    const float d2 = lengthSquared(toLight);
    if (!(d2 > 0.0f)) return false;
    sample.direction = toLight / std::sqrt(d2);
    const float cosine = -dot(sample.direction, point.normal);
    if (!(cosine > 0.0f)) return false;
    sample.pdfSolidAngle = probability * d2 / (area * cosine);
    sample.isPoint = false;
    sample.shadowRay = shadowSegment(rayOrigin(surface, sample.direction), point.position,
                                     point.normal, point.offset);
    return true;
}

// Uniform over the solid angle that the sphere fills (source: Shirley & Wang 1994); where a texture
// shows mostly some part of it, half of the choices by what it shows.
bool LightSampler::sampleSphere(const Surface& surface, const Light& light, float probability,
                                Vec2f u, LightSample& sample) const {
    if (m_scene.lampTexture(light)) {
        const bool byTexture = u.x < kTextureShare;
        u.x = byTexture ? u.x / kTextureShare : (u.x - kTextureShare) / (1.0f - kTextureShare);
        if (byTexture) return sampleTexturedSphere(surface, light, probability, u, sample);
    }
    const SphereShape sphere = m_scene.sphere(light.shape);
    const Vec3d toCentre = sphere.centre - Vec3d(surface.position);
    const double d2 = lengthSquared(toCentre), r2 = sphere.radius * sphere.radius;
    if (!(d2 > r2 * (1 + 1e-6))) return false;  // inside: the front looks away
    const float oneMinusCos = oneMinusCosOfSphere(r2, d2);
    const Frame frame(Vec3f(toCentre / std::sqrt(d2)));
    sample.direction = frame.toWorld(sampleUniformCone(u, oneMinusCos));
    sample.direction = normalize(sample.direction);
    const Vec3d direction(sample.direction);
    double t =
        intersectSphere(Vec3d(surface.position), direction, 1e300, sphere.centre, sphere.radius);
    if (t < 0) t = dot(toCentre, direction);  // grazing, lost to rounding: the nearest point
    const Surface point =
        m_scene.pointOnSphere(light.shape, Vec3d(surface.position) + direction * t - sphere.centre);
    sample.radiance = frontRadiance(point);
    sample.pdfSolidAngle = probability / (2.0f * kPi * oneMinusCos);
    if (m_scene.lampTexture(light))
        sample.pdfSolidAngle = probability * pdfOfTexturedSphere(surface, sample.direction, point);
    sample.isPoint = false;
    sample.shadowRay = shadowSegment(rayOrigin(surface, sample.direction), point.position,
                                     point.geometricNormal, point.offset);
    return true;
}

bool LightSampler::sampleTexturedSphere(const Surface& surface, const Light& light,
                                        float probability, Vec2f u, LightSample& sample) const {
    float density;
    const Surface point = m_scene.pointOnLight(light, u, density);
    if (!sampleTriangle(surface, {point.position, point.offset, point.geometricNormal}, probability,
                        light.area / density, sample))
        return false;
    sample.radiance = frontRadiance(point);
    sample.pdfSolidAngle = probability * pdfOfTexturedSphere(surface, sample.direction, point);
    return true;
}

float LightSampler::pdfOfTexturedSphere(const Surface& from, const Vec3f& direction,
                                        const Surface& point) const {
    const Light& light = m_scene.lights()[static_cast<std::size_t>(point.light)];
    const SphereShape sphere = m_scene.sphere(light.shape);
    const double d2 = lengthSquared(sphere.centre - Vec3d(from.position));
    const double r2 = sphere.radius * sphere.radius;
    if (!(d2 > r2 * (1 + 1e-6))) return 0.0f;
    const float even = 1.0f / (2.0f * kPi * oneMinusCosOfSphere(r2, d2));
    const float cosine = -dot(direction, point.geometricNormal);
    if (!(cosine > 0.0f)) return (1.0f - kTextureShare) * even;
    return (1.0f - kTextureShare) * even + kTextureShare * m_scene.lampDensity(light, point) *
                                               lengthSquared(point.position - from.position) /
                                               (light.area * cosine);
}

bool LightSampler::samplePoint(const Surface& surface, const Light& light, float probability,
                               LightSample& sample) const {
    const Vec3d toLight = light.position - Vec3d(surface.position);
    const double d2 = lengthSquared(toLight);
    if (!(d2 > 0)) return false;
    sample.direction = Vec3f(toLight / std::sqrt(d2));
    sample.radiance = light.intensity * static_cast<float>(1 / d2);
    if (light.kind == Light::Kind::kSpot) {
        sample.radiance *= m_scene.beam(light).intensity(-sample.direction);
        if (isBlack(sample.radiance)) return false;
    }
    sample.pdfSolidAngle = probability;
    sample.isPoint = true;
    const Vec3f origin = rayOrigin(surface, sample.direction);
    sample.shadowRay = {origin, Vec3f(light.position - Vec3d(origin)), 1.0f};
    return true;
}

bool LightSampler::sampleFar(const Surface& surface, const Light& light, float probability, Vec2f u,
                             LightSample& sample) const {
    float pdf = 1.0f;
    sample.isPoint = false;
    if (light.kind == Light::Kind::kEnvironment) {
        sample.direction = m_skyGuide ? m_skyGuide->sample(surface.position, u, pdf)
                                      : m_scene.environment().sample(u, pdf);
        sample.radiance = m_scene.environment().radiance(sample.direction);
    } else {
        const Beam& beam = m_scene.beam(light);
        sample.direction = -beam.axis;
        sample.radiance = light.intensity;
        sample.isPoint = beam.isDelta();
        if (!beam.isDelta()) {
            sample.direction =
                normalize(Frame(sample.direction).toWorld(sampleUniformCone(u, beam.oneMinusCos)));
            pdf = 1.0f / (2.0f * kPi * beam.oneMinusCos);
        }
    }
    sample.pdfSolidAngle = probability * pdf;
    sample.shadowRay = rayFrom(surface, sample.direction);
    return !isBlack(sample.radiance);
}

float LightSampler::farPdfSolidAngle(const Surface& from, const Vec3f& direction,
                                     std::size_t far) const {
    const std::size_t index = m_scene.nearLights().size() + far;
    const Light& light = m_scene.lights()[index];
    const float probability = this->probability(from, direction, static_cast<std::uint32_t>(index));
    if (light.kind == Light::Kind::kEnvironment)
        return probability * (m_skyGuide ? m_skyGuide->pdfSolidAngle(from.position, direction)
                                         : m_scene.environment().pdfSolidAngle(direction));
    const Beam& beam = m_scene.beam(light);
    return !beam.isDelta() && beam.holds(-direction) ? probability / (2.0f * kPi * beam.oneMinusCos)
                                                     : 0.0f;
}

float LightSampler::pdfSolidAngle(const Surface& from, const Vec3f& direction,
                                  const Surface& onLight) const {
    const auto index = static_cast<std::size_t>(onLight.light);
    const Light& light = m_scene.lights()[index];
    const float probability = this->probability(from, direction, static_cast<std::uint32_t>(index));
    if (light.kind == Light::Kind::kSphere) {
        if (m_scene.lampTexture(light))
            return probability * pdfOfTexturedSphere(from, direction, onLight);
        const SphereShape sphere = m_scene.sphere(light.shape);
        const double d2 = lengthSquared(sphere.centre - Vec3d(from.position));
        const double r2 = sphere.radius * sphere.radius;
        return d2 > r2 * (1 + 1e-6) ? probability / (2.0f * kPi * oneMinusCosOfSphere(r2, d2))
                                    : 0.0f;
    }
    const float cosine = -dot(direction, onLight.geometricNormal);
    if (!(cosine > 0.0f)) return 0.0f;
    return probability * lengthSquared(onLight.position - from.position) / (light.area * cosine) *
           m_scene.lampDensity(light, onLight);
}

}  // namespace pm
