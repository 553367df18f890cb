// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/transport/path/path_integrator.h"

#include "integrator/transport/path/path_walk.h"

namespace pm {

SampleRadiance PathIntegrator::sample(const Ray& ray, Sampler& sampler,
                                      const RayFootprint& footprint) const {
    SampleRadiance result;
    PathState state;
    PathWalk path(ray, footprint);
    LastScatter last;
    last.direction = ray.direction;
    while (true) {
        const CacheWatch::As as(path.user());
        Surface surface;
        ++result.rays;
        if (!meet(m_scene, path.ray, surface, &path.footprint, path.throughput)) {
            result.of(state.classify()) +=
                path.throughput * weightedFarLight(m_scene, m_lights, last);
            return result;
        }
        result.of(state.classify()) += path.throughput * weightedEmission(m_lights, surface, last);
        const Bsdf bsdf(m_scene.materials(), surface, -path.ray.direction, Transport::kRadiance,
                        path.throughput);
        recordFirstHit(surface, bsdf, result);
        if (bsdf.isBlackBody()) return result;
        if (bsdf.reflectsLamps()) {
            const DirectRadiance direct =
                estimateDirect(m_scene, m_lights, surface, bsdf, LampStrategy::kBoth,
                               state.hasMetNoDiffuse(), 1, sampler, result.rays);
            for (const Lobe lobe : {Lobe::kDiffuse, Lobe::kGlossy, Lobe::kWide, Lobe::kBroad}) {
                if (!bsdf.has(lobe)) continue;
                PathState by = state;
                by.scatter(lobe);
                result.of(by.classify()) += path.throughput * direct.of(lobe);
            }
        }
        BsdfSample sample;
        const float uLobe = sampler.next1D();
        const Vec2f u = sampler.next2D();
        if (!bsdf.sample(uLobe, u, sample)) return result;
        if (!path.scatter(surface, bsdf, sample, sampler)) {
            if (path.isCut()) result.addCut(path.amount());
            return result;
        }
        state.scatter(sample.lobe);
        if (sample.lobe == Lobe::kStraight) continue;
        last = lastScatter(surface, sample);
        if (m_scene.viewersDiffer() && !isDelta(sample.lobe)) {
            result.of(state.classify()) +=
                path.throughput * lightAlong(m_scene, m_lights, path.ray, last, result.rays);
            last.hasLamps = true;
        }
    }
}

}  // namespace pm
