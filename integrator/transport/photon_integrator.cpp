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

// Camera paths divide at the first glass they meet, where both parts carry more than this.
constexpr float kLeastDivided = 0.001f;

std::uint32_t ownGatherRays(const GatherPoints* points) {
    return points ? std::max(kFewestOwnRays, points->raysOfPoint() / kRaysOfPointToAnOwnRay)
                  : kFewestOwnRays;
}

bool reflectsLamps(const Bsdf& bsdf) {
    return bsdf.has(Lobe::kDiffuse) || bsdf.has(Lobe::kGlossy);
}

}  // namespace

SampleRadiance PhotonIntegrator::sample(Vec2f screen, const Ray& ray, Sampler& sampler,
                                        NearestPhotons& scratch, bool withSeenLamps) const {
    SampleRadiance result;
    Branch branch{PathWalk(ray), {}, {}, m_lampSamples};
    branch.last.direction = ray.direction;
    std::optional<Branch> reflected;
    follow(screen, branch, &reflected, sampler, scratch, withSeenLamps, result);
    if (reflected) follow(screen, *reflected, nullptr, sampler, scratch, withSeenLamps, result);
    return result;
}

// What glass reflects is a few per cent: chosen that rarely, the image of a bright caustic would be
// a speck.
bool PhotonIntegrator::divide(const Surface& surface, const Bsdf& bsdf, const Branch& branch,
                              std::optional<Branch>& reflected, BsdfSample& refraction,
                              Sampler& sampler) {
    BsdfSample reflection;
    for (const Lobe other : {Lobe::kDiffuse, Lobe::kGlossy, Lobe::kStraight})
        if (bsdf.has(other)) return false;
    if (!bsdf.follow(Lobe::kReflection, reflection) || !bsdf.follow(Lobe::kRefraction, refraction))
        return false;
    for (const BsdfSample& sample : {reflection, refraction})
        if (maxChannel(branch.path.throughput * sample.weight) < kLeastDivided) return false;
    reflected = branch;
    if (!reflected->goOn(surface, bsdf, reflection, sampler)) reflected.reset();
    return true;
}

bool PhotonIntegrator::Branch::goOn(const Surface& surface, const Bsdf& bsdf,
                                    const BsdfSample& sample, Sampler& sampler) {
    if (!path.scatter(surface, bsdf, sample, sampler)) return false;
    state.scatter(sample.lobe);
    last = {surface, sample.direction, sample.lobe, sample.pdfSolidAngle, lampSamples};
    return true;
}

void PhotonIntegrator::follow(Vec2f screen, Branch& branch, std::optional<Branch>* reflected,
                              Sampler& sampler, NearestPhotons& scratch, bool withSeenLamps,
                              SampleRadiance& result) const {
    auto& [path, state, last, lampSamples] = branch;
    for (bool first = reflected != nullptr;; first = false) {
        Surface surface;
        ++result.rays;
        if (!m_scene.intersect(path.ray, surface)) {
            result.of(state.classify()) +=
                path.throughput * weightedFarLight(m_scene, m_lights, last);
            return;
        }
        const PathClass found = state.classify();
        if (withSeenLamps || found != PathClass::kEmission)
            result.of(found) += path.throughput * weightedEmission(m_lights, surface, last);
        const Bsdf bsdf(m_scene, surface, -path.ray.direction, Transport::kRadiance,
                        path.throughput);
        if (first) recordFirstHit(surface, bsdf, result);
        if (bsdf.isBlackBody()) return;
        const StillToFind still =
            addReflected(screen, surface, bsdf, branch, sampler, scratch, result);
        if (bsdf.isDiffuseOnly() && still.lamps == LampStrategy::kNextEventOnly && !still.indirect)
            return;
        BsdfSample sample;
        if (reflected && divide(surface, bsdf, branch, *reflected, sample, sampler)) {
            reflected = nullptr;
            if (!branch.goOn(surface, bsdf, sample, sampler)) return;
            continue;
        }
        const float uLobe = sampler.next1D();
        const Sampler directions = sampler;
        const bool valid = bsdf.sample(uLobe, sampler.next2D(), sample);
        if (sample.lobe == Lobe::kDiffuse)
            return followDiffuse(surface, bsdf, branch, still, uLobe, directions, result);
        if (!valid || !branch.goOn(surface, bsdf, sample, sampler)) return;
        if (reflectsLamps(bsdf)) lampSamples = 1;
    }
}

// All light that a surface reflects by lobes that are not delta, but for what a ray along the
// diffuse one has to find.
PhotonIntegrator::StillToFind PhotonIntegrator::addReflected(Vec2f screen, const Surface& surface,
                                                             const Bsdf& bsdf, const Branch& branch,
                                                             Sampler& sampler,
                                                             NearestPhotons& scratch,
                                                             SampleRadiance& result) const {
    const Rgb& throughput = branch.path.throughput;
    StillToFind still;
    if (bsdf.has(Lobe::kDiffuse))
        still = readMaps(screen, surface, bsdf, throughput, scratch, result);
    if (still.indirect && m_maps.lamps) sampleCaustics(surface, bsdf, throughput, sampler, result);
    if (reflectsLamps(bsdf)) {
        const DirectRadiance direct = estimateDirect(m_scene, m_lights, surface, bsdf, still.lamps,
                                                     branch.lampSamples, sampler, result.rays);
        result.direct += throughput * (direct.diffuse + direct.glossy);
    }
    return still;
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
    if (still.indirect && m_maps.refocused) {
        // Any pattern that depends on the place alone.
        const auto pattern = std::bit_cast<std::uint32_t>(surface.position.x) ^
                             std::bit_cast<std::uint32_t>(surface.position.y);
        add(m_maps.points ? m_maps.points->refocusedAt(place, indirect.clearance, pattern)
                          : m_maps.refocused->at(surface.position, normal, pattern),
            result.indirect);
    }
    return still;
}

// uLobe: has chosen the lobe.
void PhotonIntegrator::followDiffuse(const Surface& surface, const Bsdf& bsdf, const Branch& branch,
                                     StillToFind still, float uLobe, const Sampler& directions,
                                     SampleRadiance& result) const {
    const std::uint32_t rays = still.indirect ? ownGatherRays(m_maps.points) : 1;
    const Rgb share = branch.path.throughput / static_cast<float>(rays);
    std::optional<GatherGuide::Directions> guide;
    // For lamps that such rays meet, too: the weights of the two strategies sum to 1 in every
    // direction, by whichever density the rays come.
    if (still.indirect && m_maps.points)
        guide = m_maps.points->directionsAt(surface.position, Frame(bsdf.facingShadingNormal()));
    for (std::uint32_t i = 0; i < rays; ++i) {
        // All those of a pixel are one low-discrepancy sequence.
        Sampler part = directions.part(rays, i);
        BsdfSample sample;
        const auto [u, density] = GatherGuide::warp(guide, part.next2D());
        if (!bsdf.sample(uLobe, u, sample)) continue;
        const LastScatter last{surface, sample.direction, sample.lobe, sample.pdfSolidAngle,
                               branch.lampSamples};
        gatherAlong(last, still, share * sample.weight / density, rays,
                    dot(sample.direction, bsdf.facingShadingNormal()), part, result);
    }
}

// What a sample's own gather rays leave out of the light that caustics send straight to a surface.
void PhotonIntegrator::sampleCaustics(const Surface& surface, const Bsdf& bsdf,
                                      const Rgb& throughput, Sampler sampler,
                                      SampleRadiance& result) const {
    const std::uint32_t rays = ownGatherRays(m_maps.points);
    const Vec3f& up = bsdf.facingGeometricNormal();
    const VirtualLamps::Place place{surface.position, surface.position + up * surface.offset,
                                    bsdf.facingShadingNormal(), up};
    result.rays += VirtualLamps::raysBeside(rays);
    result.indirect +=
        throughput * bsdf.diffuse() * kInvPi * m_maps.lamps->sampled(place, rays, sampler.next1D());
}

// Light that the ray finds at a lamp is direct, the other strategy of its next-event estimation;
// light found by way of other lobes is a caustic and its map's business.
void PhotonIntegrator::gatherAlong(const LastScatter& last, StillToFind still, const Rgb& weight,
                                   std::uint32_t rays, float cosine, Sampler& sampler,
                                   SampleRadiance& result) const {
    const Ray ray = rayFrom(last.from, last.direction);
    Gathered found;
    if (still.indirect) {
        found = finalGather(m_scene, {*m_maps.global, m_maps.lamps, rays}, ray, cosine, sampler);
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
