// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/transport/photon_integrator.h"

#include <algorithm>
#include <bit>

#include "integrator/sampling/warps.h"
#include "integrator/transport/final_gather.h"
#include "integrator/transport/path_walk.h"

namespace pm {

namespace {

// Lamps that fill less than this share of the cosine-weighted view are found by next-event
// estimation alone: the other strategy's weight is below its square there.
constexpr float kLargeLampShare = 0.02f;
// Where there are no gather points a sample sends rays of its own: few, as it is one of many, and
// more where the points have many.
constexpr std::uint32_t kFewestOwnRays = 4, kRaysOfPointToAnOwnRay = 8;

std::uint32_t ownGatherRays(const GatherPoints* points) {
    return points ? std::max(kFewestOwnRays, points->raysOfPoint() / kRaysOfPointToAnOwnRay)
                  : kFewestOwnRays;
}

}  // namespace

SampleRadiance PhotonIntegrator::sample(Vec2f screen, const Ray& ray, Sampler& sampler,
                                        NearestPhotons& scratch, bool withSeenLamps) const {
    SampleRadiance result;
    PathState state;
    PathWalk path(ray);
    LastScatter last;
    last.direction = ray.direction;
    std::uint32_t lampSamples = m_lampSamples;
    for (bool first = true;; first = false) {
        Surface surface;
        ++result.rays;
        if (!m_scene.intersect(path.ray, surface)) {
            result.of(state.classify()) +=
                path.throughput * weightedFarLight(m_scene, m_lights, last);
            return result;
        }
        const PathClass found = state.classify();
        if (withSeenLamps || found != PathClass::kEmission)
            result.of(found) += path.throughput * weightedEmission(m_lights, surface, last);
        const Bsdf bsdf(m_scene, surface, -path.ray.direction, Transport::kRadiance,
                        path.throughput);
        if (first) recordFirstHit(surface, bsdf, result);
        if (bsdf.isBlackBody()) return result;
        StillToFind still;
        if (bsdf.has(Lobe::kDiffuse))
            still = readMaps(screen, surface, bsdf, path.throughput, scratch, result);
        const bool reflectsLamps = bsdf.has(Lobe::kDiffuse) || bsdf.has(Lobe::kGlossy);
        if (reflectsLamps) {
            const DirectRadiance direct = estimateDirect(
                m_scene, m_lights, surface, bsdf, still.lamps, lampSamples, sampler, result.rays);
            result.direct += path.throughput * (direct.diffuse + direct.glossy);
        }
        if (bsdf.isDiffuseOnly() && still.lamps == LampStrategy::kNextEventOnly && !still.indirect)
            return result;
        BsdfSample sample;
        const float uLobe = sampler.next1D();
        bool valid = bsdf.sample(uLobe, sampler.next2D(), sample);
        if (sample.lobe == Lobe::kDiffuse) {
            const std::uint32_t rays = still.indirect ? ownGatherRays(m_maps.points) : 1;
            const Rgb share = path.throughput / static_cast<float>(rays);
            for (std::uint32_t i = 0; i < rays; ++i) {
                if (i > 0) valid = bsdf.sample(uLobe, sampler.next2D(), sample);
                if (!valid) continue;
                last = {surface, sample.direction, sample.lobe, sample.pdfSolidAngle, lampSamples};
                followDiffuse(last, still, share * sample.weight, sampler, result);
            }
            return result;
        }
        if (!valid) return result;
        if (!path.scatter(surface, bsdf, sample, sampler)) return result;
        state.scatter(sample.lobe);
        last = {surface, sample.direction, sample.lobe, sample.pdfSolidAngle, lampSamples};
        if (reflectsLamps) lampSamples = 1;
    }
}

PhotonIntegrator::StillToFind PhotonIntegrator::readMaps(Vec2f screen, const Surface& surface,
                                                         const Bsdf& bsdf, const Rgb& throughput,
                                                         NearestPhotons& scratch,
                                                         SampleRadiance& result) const {
    const Rgb reflected = throughput * bsdf.diffuse() * kInvPi;
    const auto add = [&](const TwoRadii& irradiance, Rgb& part) {
        part += reflected * irradiance.wide;
        result.biasProbe += reflected * (irradiance.narrow - irradiance.wide);
    };
    StillToFind still;
    GatherPoints::Estimate indirect;
    const GatherPoints::Place place{screen, surface.position, bsdf.facingShadingNormal(),
                                    bsdf.facingGeometricNormal(), surface.offset};
    const bool kept = m_maps.points && m_maps.points->estimate(place, indirect);
    result.rays += indirect.rays;
    if (kept) {
        add(indirect.irradiance, result.indirect);
        if (indirect.lampShare < kLargeLampShare) still.lamps = LampStrategy::kNextEventOnly;
    }
    const Vec3f& normal = bsdf.facingGeometricNormal();
    if (m_maps.caustic)
        add(m_maps.caustic->irradiance(surface.position, normal, scratch), result.caustic);
    still.indirect = !kept && m_maps.global;
    if (still.indirect && m_maps.descended) {
        // Any pattern that depends on the place alone.
        const auto pattern = std::bit_cast<std::uint32_t>(surface.position.x) ^
                             std::bit_cast<std::uint32_t>(surface.position.y);
        add(m_maps.points ? m_maps.points->descendedAt(place, pattern)
                          : m_maps.descended->at(surface.position, normal, pattern),
            result.indirect);
    }
    return still;
}

// Light that the ray finds at a lamp is direct, the other strategy of its next-event estimation;
// light found by way of other lobes is a caustic and its map's business.
void PhotonIntegrator::followDiffuse(const LastScatter& last, StillToFind still, const Rgb& weight,
                                     Sampler& sampler, SampleRadiance& result) const {
    const Ray ray = rayFrom(last.from, last.direction);
    Gathered found;
    if (still.indirect) {
        found = finalGather(m_scene, *m_maps.global, ray, sampler);
        result.rays += found.rays;
        result.indirect += weight * found.radiance.wide;
        result.biasProbe += weight * (found.radiance.narrow - found.radiance.wide);
    } else if (still.lamps == LampStrategy::kBoth) {
        ++result.rays;
        found.hitAny = m_scene.intersect(ray, found.first);
    }
    if (still.lamps != LampStrategy::kBoth) return;
    result.direct += weight * (found.hitAny ? weightedEmission(m_lights, found.first, last)
                                            : weightedFarLight(m_scene, m_lights, last));
}

}  // namespace pm
