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
    const bool isFound = sampleOf(chosen, surface, sample);
    sample.shadowRay.time = surface.time;
    return isFound;
}

bool LightSampler::sampleOf(const ChosenLight& chosen, const Surface& surface,
                            LightSample& sample) const {
    const float probability = chosen.probability;
    const Vec2f uPoint = chosen.u;
    if (const LampTriangle& lamp = m_scene.lampTriangle(chosen.light)) {
        sample.radiance = m_scene.material(lamp.material).emission;
        return sampleLampPoint(surface, lamp.point(uPoint), probability, lamp.area, sample);
    }
    const Light& light = m_scene.lights()[chosen.light];
    if (m_skyGuide && light.environment()) {
        FarLook look;
        look.direction = m_skyGuide->sample(surface.position, uPoint, look.pdfSolidAngle);
        look.radiance = light.farRadiance(look.direction);
        return sampleFar(look, surface, probability, sample);
    }
    return light.sample(m_scene, surface, uPoint, probability, sample);
}

float LightSampler::farPdfSolidAngle(const Surface& from, const Vec3f& direction,
                                     std::size_t far) const {
    const std::size_t index = m_scene.nearLights().size() + far;
    const Light& light = m_scene.lights()[index];
    const float probability = this->probability(from, direction, static_cast<std::uint32_t>(index));
    if (m_skyGuide && light.environment())
        return probability * m_skyGuide->pdfSolidAngle(from.position, direction);
    return light.farPdfSolidAngle(direction, probability);
}

float LightSampler::pdfSolidAngle(const Surface& from, const Vec3f& direction,
                                  const Surface& onLight) const {
    const auto index = static_cast<std::size_t>(onLight.light);
    const Light& light = m_scene.lights()[index];
    const float probability = this->probability(from, direction, static_cast<std::uint32_t>(index));
    return light.pdfSolidAngle(m_scene, from, direction, onLight, probability);
}

}  // namespace pm
