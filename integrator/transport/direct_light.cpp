// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/transport/direct_light.h"

#include <algorithm>
#include <span>

#include "integrator/sampling/warps.h"

namespace pm {

namespace {

// By one of `samples` lamp samples, to be divided by their number.
DirectRadiance byLampSample(const Scene& scene, const LightSampler& lights, const Surface& surface,
                            const Bsdf& bsdf, LampStrategy diffuse, float samples, Vec2f u,
                            std::uint32_t& rays) {
    DirectRadiance result;
    LightSample light;
    if (!lights.sample(surface, bsdf.facingGeometricNormal(), u, light) ||
        !(light.pdfSolidAngle > 0.0f))
        return result;
    const auto contribution = [&](Lobe lobe) {
        if (!bsdf.has(lobe)) return Rgb{};
        const Rgb value = bsdf.evaluate(lobe, light.direction);
        if (isBlack(value)) return Rgb{};
        const bool alone =
            light.isPoint || (lobe == Lobe::kDiffuse && diffuse == LampStrategy::kNextEventOnly);
        const float weight = alone ? 1.0f
                                   : powerHeuristic(samples * light.pdfSolidAngle,
                                                    bsdf.pdfSolidAngle(lobe, light.direction));
        return value * light.radiance * (weight / light.pdfSolidAngle);
    };
    result.diffuse = contribution(Lobe::kDiffuse);
    result.glossy = contribution(Lobe::kGlossy);
    if (isBlack(result.diffuse) && isBlack(result.glossy)) return result;
    ++rays;
    if (scene.occluded(light.shadowRay)) return {};
    return result;
}

}  // namespace

DirectRadiance estimateDirect(const Scene& scene, const LightSampler& lights,
                              const Surface& surface, const Bsdf& bsdf, LampStrategy diffuse,
                              std::uint32_t samples, Sampler& sampler, std::uint32_t& rays) {
    DirectRadiance sum;
    const auto number = static_cast<float>(samples);
    for (std::uint32_t i = 0; i < samples; ++i) {
        const DirectRadiance one = byLampSample(scene, lights, surface, bsdf, diffuse, number,
                                                sampler.part(samples, i).next2D(), rays);
        sum.diffuse += one.diffuse;
        sum.glossy += one.glossy;
    }
    sampler.skip();
    return {sum.diffuse / number, sum.glossy / number};
}

Rgb weightedEmission(const LightSampler& lights, const Surface& surface, const LastScatter& last) {
    if (surface.light == kNoLight) return {};
    const Rgb emitted = lights.emittedRadiance(surface, -last.direction);
    if (isDelta(last.lobe) || isBlack(emitted)) return emitted;
    return emitted * powerHeuristic(last.pdfSolidAngle,
                                    static_cast<float>(last.lampSamples) *
                                        lights.pdfSolidAngle(last.from, last.direction, surface));
}

Rgb weightedFarLight(const Scene& scene, const LightSampler& lights, const LastScatter& last) {
    Rgb sum;
    const std::span<const Light> far = scene.farLights();
    for (std::size_t i = 0; i < far.size(); ++i) {
        const Rgb radiance = scene.farRadiance(far[i], last.direction);
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

void recordFirstHit(const Surface& surface, const Bsdf& bsdf, SampleRadiance& result) {
    result.coverage = 1.0f;
    result.albedo = bsdf.albedo();
    result.normal = bsdf.facingShadingNormal();
    result.firstPosition = surface.position;
    result.firstShape = surface.shape;
    result.firstMaterial = surface.material;
}

}  // namespace pm
