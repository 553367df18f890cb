// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/transport/gather/final_gather.h"

#include <algorithm>

#include "integrator/sampling/warps.h"
#include "integrator/transport/path/direct_light.h"
#include "integrator/transport/path/path_walk.h"

namespace pm {

namespace {

// A gather ray's way by lobes that don't end it.
struct GatherWay {
    PathWalk path;
    LastScatter last;
    bool byBroadOnly = true;

    // Whether light of lamps that the last lobe leads to, or reflects, is the ray's business.
    static bool isAsked(const GatherEnds& ends, Lobe lobe) {
        return ends.lights && (lobe == Lobe::kBroad || (ends.findsAll && !ends.withoutCaustics));
    }
};

// met: null where the ray meets nothing. atOnce: by no lobe.
void addLampsMet(const Scene& scene, const GatherEnds& ends, const GatherWay& way,
                 const Surface* met, bool atOnce, Gathered& result) {
    if (atOnce) {
        if (!ends.from) return;
        result.lampsStraight +=
            way.path.throughput * (met ? weightedEmission(*ends.lights, *met, *ends.from)
                                       : weightedFarLight(scene, *ends.lights, *ends.from));
        return;
    }
    if (!GatherWay::isAsked(ends, way.last.lobe)) return;
    const Rgb light = way.path.throughput * (met ? weightedEmission(*ends.lights, *met, way.last)
                                                 : weightedFarLight(scene, *ends.lights, way.last));
    result.radiance += {light, light};
}

// By a sample of lamps, whether or not the lobe will be followed: else few rays would bring much.
void addLampsSampled(const Scene& scene, const GatherEnds& ends, const GatherWay& way,
                     const Surface& surface, const Bsdf& bsdf, Sampler& sampler, Gathered& result) {
    const auto isAsked = [&](Lobe lobe) {
        return bsdf.has(lobe) && GatherWay::isAsked(ends, lobe);
    };
    if (std::ranges::none_of(kShinyLobes, isAsked)) return;
    const DirectRadiance direct = estimateDirect(
        scene, *ends.lights, surface, bsdf, LampStrategy::kNone, false, 1, sampler, result.rays);
    Rgb sum;
    for (const Lobe lobe : kShinyLobes)
        if (isAsked(lobe)) sum += direct.of(lobe);
    const Rgb light = way.path.throughput * sum;
    result.radiance += {light, light};
}

// The end of the way at a surface with a diffuse lobe, as endGather will read it.
// first: the gather ray.
void setEnd(const Scene& scene, const GatherEnds& ends, const GatherWay& way, const Ray& first,
            const Surface& surface, const Bsdf& bsdf, float cosine, bool atOnce, Gathered& result) {
    const Ray& ray = way.path.ray;
    result.isWaiting = true;
    result.normal = bsdf.facingGeometricNormal();
    result.position = scene.pointUnderRay(surface.position, ray, result.normal);
    result.reflected = bsdf.reflectedOf(way.path.throughput);
    result.density = 0.0f;
    result.readsCaustics = ends.caustics && (ends.findsAll || (!atOnce && way.byBroadOnly));
    if (ends.caustics && atOnce && !ends.findsAll) {
        const float facing = -dot(ray.direction, result.normal);
        result.density = cosine * kInvPi * facing / lengthSquared(surface.position - first.origin);
    }
    if (result.density > 0.0f || result.readsCaustics)
        ends.caustics->prefetch(result.position, result.normal);
    ends.sites.prefetch(result.position, result.normal);
}

}  // namespace

Gathered followGather(const Scene& scene, const GatherEnds& ends, const Ray& ray, float cosine,
                      Sampler& sampler) {
    const CacheWatch::As as(CacheUser::kGather);
    Gathered result;
    GatherWay way{PathWalk(ray, scene.coneAround(ray.direction, ends.width)), {}};
    bool atOnce = true;
    while (true) {
        Surface surface;
        ++result.rays;
        const bool hit =
            meet(scene, way.path.ray, surface, &way.path.footprint, way.path.throughput);
        addLampsMet(scene, ends, way, hit ? &surface : nullptr, atOnce, result);
        if (!hit) return result;
        if (!result.hitAny) {
            result.first = surface;
            result.hitAny = true;
        }
        const Bsdf bsdf(scene.materials(), surface, -way.path.ray.direction, Transport::kRadiance,
                        way.path.throughput);
        if (bsdf.isBlackBody()) return result;
        if (bsdf.has(Lobe::kDiffuse)) {
            setEnd(scene, ends, way, ray, surface, bsdf, cosine, atOnce, result);
            if (bsdf.isDiffuseOnly()) return result;
            endGather(ends, result);
        }
        addLampsSampled(scene, ends, way, surface, bsdf, sampler, result);
        BsdfSample sample;
        const float uLobe = sampler.next1D();
        const Vec2f u = sampler.next2D();
        if (!bsdf.sample(uLobe, u, sample) || sample.lobe == Lobe::kDiffuse ||
            !way.path.scatter(surface, bsdf, sample, sampler))
            return result;
        if (sample.lobe == Lobe::kStraight) continue;
        atOnce = false;
        way.last = lastScatter(surface, sample);
        if (scene.viewersDiffer() && !isDelta(sample.lobe) &&
            GatherWay::isAsked(ends, sample.lobe)) {
            const Rgb light = way.path.throughput *
                              lightAlong(scene, *ends.lights, way.path.ray, way.last, result.rays);
            result.radiance += {light, light};
            way.last.hasLamps = true;
        }
        way.byBroadOnly = way.byBroadOnly && sample.lobe == Lobe::kBroad;
    }
}

void endGather(const GatherEnds& ends, Gathered& gathered) {
    if (!gathered.isWaiting) return;
    const CacheWatch::As as(CacheUser::kGather);
    gathered.isWaiting = false;
    TwoRadii irradiance = ends.sites.at(gathered.position, gathered.normal);
    if (gathered.density > 0.0f)
        irradiance += ends.caustics->gathered(gathered.position, gathered.normal, gathered.density,
                                              ends.rays);
    else if (gathered.readsCaustics)
        irradiance += ends.caustics->kept(gathered.position, gathered.normal);
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
