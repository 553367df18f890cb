// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/transport/final_gather.h"

#include "integrator/sampling/warps.h"
#include "integrator/transport/path_walk.h"

namespace pm {

Gathered followGather(const Scene& scene, const GatherEnds& ends, const Ray& ray, float cosine,
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
            result.normal = bsdf.facingGeometricNormal();
            result.position = pointUnderRay(surface.position, path.ray, result.normal,
                                            scene.liftOfRays(surface.position));
            result.reflected = path.throughput * bsdf.diffuse() * kInvPi;
            result.density = 0.0f;
            if (ends.caustics && result.rays == 1) {
                const float facing = -dot(ray.direction, result.normal);
                result.density =
                    cosine * kInvPi * facing / lengthSquared(surface.position - ray.origin);
                ends.caustics->prefetch(result.position, result.normal);
            }
            ends.sites.prefetch(result.position, result.normal);
            if (bsdf.isDiffuseOnly()) return result;
            endGather(ends, result);
        }
        BsdfSample sample;
        const float uLobe = sampler.next1D();
        const Vec2f u = sampler.next2D();
        if (!bsdf.sample(uLobe, u, sample) || sample.lobe == Lobe::kDiffuse ||
            !path.scatter(surface, bsdf, sample, sampler))
            return result;
    }
}

void endGather(const GatherEnds& ends, Gathered& gathered) {
    if (!gathered.isWaiting) return;
    gathered.isWaiting = false;
    TwoRadii irradiance = ends.sites.at(gathered.position, gathered.normal);
    if (gathered.density > 0.0f)
        irradiance += ends.caustics->gathered(gathered.position, gathered.normal, gathered.density,
                                              ends.rays);
    gathered.radiance +=
        {gathered.reflected * irradiance.wide, gathered.reflected * irradiance.narrow};
}

Gathered finalGather(const Scene& scene, const GatherEnds& ends, const Ray& ray, float cosine,
                     Sampler& sampler) {
    Gathered result = followGather(scene, ends, ray, cosine, sampler);
    endGather(ends, result);
    return result;
}

}  // namespace pm
