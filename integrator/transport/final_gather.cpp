// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/transport/final_gather.h"

#include "integrator/sampling/warps.h"
#include "integrator/transport/path_walk.h"

namespace pm {

Gathered followGather(const Scene& scene, const IrradianceSites& sites, const Ray& ray,
                      Sampler& sampler) {
    Gathered result;
    PathWalk path(ray);
    while (true) {
        Surface surface;
        ++result.rays;
        if (!scene.intersect(path.ray, surface)) return result;
        if (!result.hitAny) {
            result.first = surface;
            result.hitAny = true;
        }
        const Bsdf bsdf(scene, surface, -path.ray.direction, Transport::kRadiance, path.throughput);
        if (bsdf.isBlackBody()) return result;
        if (bsdf.has(Lobe::kDiffuse)) {
            result.isWaiting = true;
            result.position = surface.position;
            result.normal = bsdf.facingGeometricNormal();
            result.reflected = path.throughput * bsdf.diffuse() * kInvPi;
            if (bsdf.isDiffuseOnly()) {
                sites.prefetch(result.position, result.normal);
                return result;
            }
            endGather(sites, result);
        }
        BsdfSample sample;
        const float uLobe = sampler.next1D();
        const Vec2f u = sampler.next2D();
        if (!bsdf.sample(uLobe, u, sample) || sample.lobe == Lobe::kDiffuse ||
            !path.scatter(surface, bsdf, sample, sampler))
            return result;
    }
}

void endGather(const IrradianceSites& sites, Gathered& gathered) {
    if (!gathered.isWaiting) return;
    gathered.isWaiting = false;
    const TwoRadii irradiance = sites.at(gathered.position, gathered.normal);
    gathered.radiance +=
        {gathered.reflected * irradiance.wide, gathered.reflected * irradiance.narrow};
}

Gathered finalGather(const Scene& scene, const IrradianceSites& sites, const Ray& ray,
                     Sampler& sampler) {
    Gathered result = followGather(scene, sites, ray, sampler);
    endGather(sites, result);
    return result;
}

}  // namespace pm
