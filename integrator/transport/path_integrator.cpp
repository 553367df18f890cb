// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/transport/path_integrator.h"

namespace pm {

SampleRadiance PathIntegrator::sample(Ray ray, Sampler& sampler) const {
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
        if (bsdf.has(Lobe::kDiffuse) || bsdf.has(Lobe::kGlossy)) {
            const DirectRadiance direct =
                estimateDirect(m_scene, m_lights, surface, bsdf, sampler, result.rays);
            PathState byDiffuse = state, byGlossy = state;
            byDiffuse.scatter(Lobe::kDiffuse);
            byGlossy.scatter(Lobe::kGlossy);
            result.of(byDiffuse.classify()) += throughput * direct.diffuse;
            result.of(byGlossy.classify()) += throughput * direct.glossy;
        }
        BsdfSample sample;
        const float uLobe = sampler.next1D();
        const Vec2f u = sampler.next2D();
        if (!bsdf.sample(uLobe, u, sample)) break;
        throughput *= sample.weight;
        if (sample.lobe == Lobe::kRefraction) etaScale *= bsdf.etaSquared();
        if (!survivesRoulette(event, etaScale, throughput, sampler)) break;
        state.scatter(sample.lobe);
        last = {surface, sample.direction, sample.lobe, sample.pdfSolidAngle};
        ray = rayFrom(surface, sample.direction);
    }
    return result;
}

}  // namespace pm
