// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/transport/photon_integrator.h"

#include "integrator/sampling/warps.h"

namespace pm {

SampleRadiance PhotonIntegrator::sample(Ray ray, Sampler& sampler, NearestPhotons& scratch) const {
    SampleRadiance result;
    PathState state;
    Rgb throughput(1.0f);
    float etaScale = 1.0f;
    LastScatter last;
    last.direction = ray.direction;
    for (int event = 0; event < kMaxPathEvents; ++event) {
        Surface surface;
        ++result.rays;
        if (!m_scene.intersect(ray, surface)) break;
        const Vec3f out = -ray.direction;
        result.of(state.classify()) += throughput * weightedEmission(m_lights, surface, last);

        const Bsdf bsdf(m_scene, surface, out, Transport::kRadiance, throughput);
        if (event == 0) recordFirstHit(surface, bsdf, result);
        if (bsdf.isBlackBody()) break;
        const bool diffuse = bsdf.has(Lobe::kDiffuse);
        if (diffuse || bsdf.has(Lobe::kGlossy)) {
            const DirectRadiance direct =
                estimateDirect(m_scene, m_lights, surface, bsdf, sampler, result.rays);
            result.direct += throughput * (direct.diffuse + direct.glossy);
        }
        if (diffuse && m_maps.caustic)
            result.caustic += throughput * bsdf.diffuse() *
                              m_maps.caustic->irradiance(surface.position,
                                                         bsdf.facingGeometricNormal(), scratch) *
                              kInvPi;
        BsdfSample sample;
        const float uLobe = sampler.next1D();
        Vec2f u = sampler.next2D();
        bool valid = bsdf.sample(uLobe, u, sample);
        // Also where the first ray has no value: the others may have.
        if (sample.lobe == Lobe::kDiffuse) {
            const Rgb share = throughput / static_cast<float>(m_gatherRays);
            for (std::uint32_t i = 0; i < m_gatherRays; ++i) {
                if (i > 0) valid = bsdf.sample(uLobe, sampler.next2D(), sample);
                if (valid) gather(surface, sample, share * sample.weight, sampler, scratch, result);
            }
            break;
        }
        if (!valid) break;
        throughput *= sample.weight;
        if (sample.lobe == Lobe::kRefraction) etaScale *= bsdf.etaSquared();
        if (!survivesRoulette(event, etaScale, throughput, sampler)) break;
        state.scatter(sample.lobe);
        last = {surface, sample.direction, sample.lobe, sample.pdfSolidAngle};
        ray = rayFrom(surface, sample.direction);
    }
    return result;
}

// From the first diffuse surface on: light found at once is direct light, the other strategy of its
// next-event estimation; light found by way of other lobes is a caustic and its map's business; at
// the second diffuse surface the global map ends the path.
void PhotonIntegrator::gather(const Surface& from, const BsdfSample& first, const Rgb& weight,
                              Sampler& sampler, NearestPhotons& scratch,
                              SampleRadiance& result) const {
    Rgb throughput = weight;
    float etaScale = 1.0f;
    Ray ray = rayFrom(from, first.direction);
    for (int event = 0; event < kMaxPathEvents; ++event) {
        Surface surface;
        ++result.rays;
        if (!m_scene.intersect(ray, surface)) return;
        if (event == 0)
            result.direct += throughput * weightedEmission(m_lights, surface,
                                                           {from, first.direction, first.lobe,
                                                            first.pdfSolidAngle});
        const Bsdf bsdf(m_scene, surface, -ray.direction, Transport::kRadiance, throughput);
        if (bsdf.isBlackBody()) return;
        if (bsdf.has(Lobe::kDiffuse) && m_maps.global)
            result.indirect +=
                throughput * bsdf.diffuse() *
                m_maps.global->at(surface.position, bsdf.facingGeometricNormal(), scratch) * kInvPi;
        BsdfSample sample;
        const float uLobe = sampler.next1D();
        const Vec2f u = sampler.next2D();
        if (!bsdf.sample(uLobe, u, sample) || sample.lobe == Lobe::kDiffuse) return;
        throughput *= sample.weight;
        if (sample.lobe == Lobe::kRefraction) etaScale *= bsdf.etaSquared();
        if (!survivesRoulette(event, etaScale, throughput, sampler)) return;
        ray = rayFrom(surface, sample.direction);
    }
}

}  // namespace pm
