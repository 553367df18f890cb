// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/transport/path/direct_light.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "integrator/paths/segment.h"
#include "integrator/sampling/warps.h"

namespace pm {

namespace {

// Lamps are chosen so many at a time, where there are several samples.
constexpr std::uint32_t kAtOnce = 16;

// What estimateDirect is asked for.
struct Question {
    const Scene& scene;
    const LightSampler& lights;
    const Surface& surface;
    const Bsdf& bsdf;
    DirectStrategy diffuse;
    bool isSeen;
    std::uint32_t samples;
    Vec3f side;  // normal of that from which light is asked for
};

// A shadow ray to the same light from another place.
Ray shadowRayFrom(const Vec3f& origin, const Ray& ray) {
    if (!std::isfinite(ray.tMax)) return {origin, ray.direction, ray.tMax, ray.viewer, ray.time};
    const Vec3f end = ray.origin + ray.direction * ray.tMax;
    return {origin, (end - origin) * (1.0f / ray.tMax), ray.tMax, ray.viewer, ray.time};
}

// Light from beyond the horizon of a face that stands for part of a curved surface, which sees it.
// No other strategy finds it. Photons and all paths that have been diffuse before know the faces
// alone: with them the light that goes on is the same by every estimator.
Rgb fromBeyondFace(const Question& asked, const LightSample& light, std::uint32_t& rays) {
    const Bsdf& bsdf = asked.bsdf;
    SmoothPoint smooth;
    if (!(dot(bsdf.facingShadingNormal(), light.direction) > 0.0f) ||
        !asked.scene.smoothPoint(asked.surface, asked.side, smooth) ||
        !(dot(smooth.normal, light.direction) > 0.0f))
        return {};
    const Rgb value = bsdf.evaluateSmooth(light.direction);
    if (isBlack(value)) return {};
    ++rays;
    const Vec3f origin = Vec3f(smooth.position) + smooth.normal * asked.surface.offset;
    return value * light.radiance *
           asked.scene.transmittance(shadowRayFrom(origin, light.shadowRay)) *
           (1.0f / light.pdfSolidAngle);
}

// By one of the lamp samples, to be divided by their number.
DirectRadiance byLampSample(const Question& asked, const ChosenLight& chosen, std::uint32_t& rays) {
    const Bsdf& bsdf = asked.bsdf;
    const auto samples = static_cast<float>(asked.samples);
    DirectRadiance result;
    LightSample light;
    if (!asked.lights.sample(chosen, asked.surface, light) || !(light.pdfSolidAngle > 0.0f))
        return result;
    if (bsdf.goesThrough() && !(dot(light.direction, asked.side) > 0.0f)) return result;
    if (asked.isSeen && !bsdf.goesThrough() && asked.diffuse != DirectStrategy::kNone &&
        bsdf.has(Lobe::kDiffuse) && !(dot(light.direction, asked.side) > 0.0f)) {
        result.of(Lobe::kDiffuse) = fromBeyondFace(asked, light, rays);
        return result;
    }
    const auto contribution = [&](Lobe lobe) {
        if (!bsdf.has(lobe)) return Rgb{};
        const Rgb value = bsdf.evaluate(lobe, light.direction);
        if (isBlack(value)) return Rgb{};
        const bool alone = light.isPoint || (lobe == Lobe::kDiffuse &&
                                             asked.diffuse == DirectStrategy::kNextEventOnly);
        const float weight = alone ? 1.0f
                                   : powerHeuristic(samples * light.pdfSolidAngle,
                                                    bsdf.pdfSolidAngle(lobe, light.direction));
        return value * light.radiance * (weight / light.pdfSolidAngle);
    };
    if (asked.diffuse != DirectStrategy::kNone)
        result.of(Lobe::kDiffuse) = contribution(Lobe::kDiffuse);
    for (const Lobe lobe : kShinyLobes) result.of(lobe) = contribution(lobe);
    if (std::ranges::all_of(result.by, [](const Rgb& c) { return isBlack(c); })) return result;
    ++rays;
    const Rgb through = asked.scene.transmittance(light.shadowRay);
    for (Rgb& c : result.by) c *= through;
    return result;
}

// Sum over all samples, whose lamps are chosen kMost at a time.
template <std::uint32_t kMost>
DirectRadiance sumOfSamples(const Question& asked, const Sampler& sampler, Purpose purpose,
                            std::uint32_t& rays) {
    DirectRadiance sum;
    std::array<ChosenLight, kMost> chosen;
    const std::span<ChosenLight> turn(chosen.data(), std::min(asked.samples, kMost));
    for (std::uint32_t next = 0; next < asked.samples;) {
        for (ChosenLight& one : turn) one.u = sampler.part(asked.samples, next++).get2D(purpose);
        asked.lights.choose(asked.surface, asked.side, turn);
        for (const ChosenLight& one : turn) {
            const DirectRadiance part = byLampSample(asked, one, rays);
            for (std::size_t i = 0; i < sum.by.size(); ++i) sum.by[i] += part.by[i];
        }
    }
    return sum;
}

}  // namespace

DirectRadiance estimateDirect(const Scene& scene, const LightSampler& lights,
                              const Surface& surface, const Bsdf& bsdf, DirectStrategy diffuse,
                              bool isSeen, std::uint32_t samples, const Sampler& sampler,
                              std::uint32_t& rays) {
    Question asked{scene,   lights, surface, bsdf,
                   diffuse, isSeen, samples, bsdf.facingGeometricNormal()};
    DirectRadiance sum;
    if (lights.empty()) return sum;
    const auto add = [&](Purpose purpose) {
        const DirectRadiance found = samples == 1
                                         ? sumOfSamples<1>(asked, sampler, purpose, rays)
                                         : sumOfSamples<kAtOnce>(asked, sampler, purpose, rays);
        for (std::size_t i = 0; i < sum.by.size(); ++i) sum.by[i] += found.by[i];
    };
    add(Purpose::kDirect);
    if (bsdf.goesThrough()) {
        asked.side = -asked.side;
        add(Purpose::kDirectBehind);
    }
    const auto number = static_cast<float>(samples);
    for (Rgb& c : sum.by) c = c / number;
    return sum;
}

Rgb weightedEmission(const LightSampler& lights, const Surface& surface, const LastScatter& last) {
    if (surface.light == kNoLight || last.hasLamps) return {};
    const Rgb emitted = lights.emittedRadiance(surface, -last.direction);
    if (isDelta(last.lobe) || isBlack(emitted)) return emitted;
    return emitted * powerHeuristic(last.pdfSolidAngle,
                                    static_cast<float>(last.lampSamples) *
                                        lights.pdfSolidAngle(last.from, last.direction, surface));
}

Rgb weightedFarLight(const Scene& scene, const LightSampler& lights, const LastScatter& last) {
    Rgb sum;
    if (last.hasLamps) return sum;
    const std::span<const Light> far = scene.farLights();
    for (std::size_t i = 0; i < far.size(); ++i) {
        const Rgb radiance = far[i].farRadiance(last.direction);
        if (isBlack(radiance)) continue;
        sum += isDelta(last.lobe)
                   ? radiance
                   : radiance *
                         powerHeuristic(last.pdfSolidAngle,
                                        static_cast<float>(last.lampSamples) *
                                            lights.farPdfSolidAngle(last.from, last.direction, i));
    }
    return sum;
}

Rgb lightAlong(const Scene& scene, const LightSampler& lights, const Ray& ray,
               const LastScatter& last, std::uint32_t& rays) {
    Rgb sum;
    Ray looking = ray;
    looking.viewer = kLightRays;
    goStraight(
        scene, looking, {},
        [&](const Surface* met, const Rgb& left) {
            ++rays;
            sum += left * (met ? weightedEmission(lights, *met, last)
                               : weightedFarLight(scene, lights, last));
            return true;
        },
        [&](const Surface& met) { return scene.isHiddenFrom(met.shape, kShadowRays); });
    return sum;
}

void recordFirstHit(const Surface& surface, const Bsdf& bsdf, SampleRadiance& result) {
    const bool isCutAway = bsdf.reflectance(Lobe::kStraight).g == 1.0f;
    if (result.coverage > 0.0f || isCutAway) return;
    result.coverage = 1.0f;
    result.albedo = bsdf.albedo();
    result.normal = bsdf.facingShadingNormal();
    result.firstPosition = surface.position;
    result.firstShape = surface.shape;
    result.firstMaterial = surface.material;
}

}  // namespace pm
