// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/transport/photon/photon_integrator.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <optional>

#include "integrator/sampling/warps.h"
#include "integrator/transport/gather/final_gather.h"
#include "integrator/transport/path/path_walk.h"

namespace pm {

namespace {

// Lamps that fill less than this share of the cosine-weighted view are found by next-event
// estimation alone: the other strategy's weight is below its square there.
constexpr float kLargeLampShare = 0.02f;
// Where there are no gather points a sample sends rays of its own: few, as it is one of many, and
// more where the points have many.
constexpr std::uint32_t kFewestOwnRays = 4, kRaysOfPointToAnOwnRay = 8;

// Of the lobes of a surface, camera paths follow all those that carry this or more, 1 where they
// begin.
constexpr float kLeastDivided = 0.03f;

// Where a place's share is below this, refocused light is estimated the more seldom.
constexpr float kLeastRefocused = 0.33f;

// Of so many rays, a power of two, those that a part of a camera sample is worth; see
// Branch::share. What their noise comes to goes with the share's square, so for its time it is
// least where their number goes with the share: to the nearest power of two.
std::uint32_t raysOfShare(std::uint32_t rays, float share) {
    constexpr float kSqrt2 = std::numbers::sqrt2_v<float>;
    const float worth = std::min(kSqrt2 * share, 1.0f) * static_cast<float>(rays);
    return std::bit_floor(std::max(1u, static_cast<std::uint32_t>(worth)));
}

std::uint32_t ownGatherRays(const GatherPoints* points, float share) {
    const std::uint32_t rays =
        points ? std::max(kFewestOwnRays, points->raysOfPoint() / kRaysOfPointToAnOwnRay)
               : kFewestOwnRays;
    return raysOfShare(rays, share);
}

// To a part of what a camera sample finds.
void add(const TwoRadii& irradiance, const Rgb& reflected, Rgb& part, SampleRadiance& result) {
    part += reflected * irradiance.wide;
    result.biasProbe += reflected * (irradiance.narrow - irradiance.wide);
}

// Of all that a surface reflects, a lobe's part.
float partOf(const Bsdf& bsdf, Lobe lobe) {
    if (bsdf.isDiffuseOnly()) return 1.0f;
    float all = 0.0f;
    for (std::size_t i = 0; i < kLobeCount; ++i)
        all += maxChannel(bsdf.reflectance(static_cast<Lobe>(i)));
    return all > 0.0f ? maxChannel(bsdf.reflectance(lobe)) / all : 0.0f;
}

bool hasSeveralLobes(const Bsdf& bsdf) {
    int lobes = 0;
    for (std::size_t i = 0; i < kLobeCount; ++i) lobes += bsdf.has(static_cast<Lobe>(i));
    return lobes > 1;
}

}  // namespace

SampleRadiance PhotonIntegrator::sample(const View& view, Sampler& sampler,
                                        NearestPhotons& scratch) const {
    SampleRadiance result;
    Branch branch{PathWalk(view.ray, view.footprint), {}, {}, m_lampSamples};
    branch.last.direction = view.ray.direction;
    follow(branch, {view, sampler, scratch, result});
    return result;
}

// Chosen by chance, what glass reflects, a few per cent, would be grain in all that is seen through
// it. So all lobes that carry enough are followed, and of those that carry less, few with more.
// Systematic sampling: their probabilities laid end to end from a random start, those are followed
// that reach a whole number.
PhotonIntegrator::Survival PhotonIntegrator::divide(const Bsdf& bsdf, const Carried& path,
                                                    bool diffuse, Sampler& sampler) {
    const bool several = hasSeveralLobes(bsdf);
    Survival survival{};
    for (std::size_t i = 0; i < kLobeCount; ++i) {
        const auto lobe = static_cast<Lobe>(i);
        if (!bsdf.has(lobe) || (lobe == Lobe::kDiffuse && !diffuse)) continue;
        const float amount = maxChannel(path.throughput * bsdf.reflectance(lobe)) * path.etaScale;
        survival[i] = several ? std::min(1.0f, amount / kLeastDivided) : 1.0f;
    }
    if (!several) return survival;
    double end = sampler.next1D();
    for (float& probability : survival) {
        const double begin = end;
        end += probability;
        if (std::floor(begin) == std::floor(end)) probability = 0.0f;
    }
    return survival;
}

bool PhotonIntegrator::Branch::goOn(const Surface& surface, const Bsdf& bsdf,
                                    const BsdfSample& sample, bool isPart, Sampler& sampler) {
    if (!path.scatter(surface, bsdf, sample, sampler, isPart)) return false;
    if (sample.lobe == Lobe::kStraight) return true;
    state.scatter(sample.lobe);
    last = lastScatter(surface, sample, lampSamples);
    return true;
}

// Where shadow rays don't meet what others do.
void PhotonIntegrator::addLampsAlong(Branch& branch, const Tree& tree) const {
    if (!m_scene.viewersDiffer() || isDelta(branch.last.lobe) || branch.last.hasLamps) return;
    SampleRadiance& result = tree.result;
    if (!isOfMap(branch.state))
        result.of(branch.state.classify()) +=
            branch.path.throughput *
            lightAlong(m_scene, m_lights, branch.path.ray, branch.last, result.rays);
    branch.last.hasLamps = true;
}

void PhotonIntegrator::follow(Branch& branch, const Tree& tree) const {
    PathWalk& path = branch.path;
    SampleRadiance& result = tree.result;
    while (true) {
        const CacheWatch::As as(path.user());
        Surface surface;
        ++result.rays;
        const PathClass found = branch.state.classify();
        const bool isFound = isOfMap(branch.state);
        if (!meet(m_scene, path.ray, surface, &path.footprint, path.throughput)) {
            if (!isFound)
                result.of(found) +=
                    path.throughput * weightedFarLight(m_scene, m_lights, branch.last);
            return;
        }
        branch.way += length(surface.position - path.ray.origin);
        if (!isFound && (tree.view.withSeenLamps || found != PathClass::kEmission))
            result.of(found) += path.throughput * weightedEmission(m_lights, surface, branch.last);
        Bsdf bsdf(m_scene.materials(), surface, -path.ray.direction, Transport::kRadiance,
                  path.throughput);
        bsdf.followAll();
        recordFirstHit(surface, bsdf, result);
        if (bsdf.isBlackBody()) return;
        // Where photons are looked up, and rays leave for lamps and light that was reflected.
        if (bsdf.has(Lobe::kDiffuse))
            surface.position =
                m_scene.pointUnderRay(surface.position, path.ray, bsdf.facingGeometricNormal());
        const StillToFind still = addReflected(surface, bsdf, branch, tree);
        if (!followLobes(surface, bsdf, still, branch, tree)) return;
    }
}

bool PhotonIntegrator::followLobes(const Surface& surface, const Bsdf& bsdf, StillToFind still,
                                   Branch& branch, const Tree& tree) const {
    if (bsdf.isDiffuseOnly()) {
        if (still.any()) followDiffuse(surface, bsdf, branch, still, 1.0f, tree);
        return false;
    }
    const Survival survival = divide(bsdf, branch.path, still.any(), tree.sampler);
    // A path that goes on by one lobe, beside those that end it, has lost the rest.
    const auto goesOn = [&](Lobe lobe) {
        return lobe != Lobe::kDiffuse && !(lobe == Lobe::kBroad && m_maps.global);
    };
    int waysOn = 0;
    for (std::size_t i = 0; i < kLobeCount; ++i)
        waysOn += survival[i] > 0.0f && goesOn(static_cast<Lobe>(i));
    std::optional<Branch> next;
    for (std::size_t i = 0; i < kLobeCount; ++i) {
        if (survival[i] == 0.0f) continue;
        const auto lobe = static_cast<Lobe>(i);
        if (lobe == Lobe::kDiffuse) {
            followDiffuse(surface, bsdf, branch, still, survival[i], tree);
            continue;
        }
        if (!goesOn(lobe)) {
            followBroad(surface, bsdf, branch, survival[i], tree);
            continue;
        }
        BsdfSample sample;
        if (!bsdf.follow(lobe, sample, isDelta(lobe) ? Vec2f{} : tree.sampler.next2D())) continue;
        sample.weight *= 1.0f / survival[i];
        Branch part = branch;
        part.share *= partOf(bsdf, lobe) / survival[i];
        if (!part.goOn(surface, bsdf, sample, waysOn > 1, tree.sampler)) {
            if (part.path.isCut()) tree.result.addCut(part.path.amount());
            continue;
        }
        addLampsAlong(part, tree);
        part.lampSamples = bsdf.reflectsLamps() ? 1
                                                : std::min(branch.lampSamples,
                                                           raysOfShare(m_lampSamples, part.share));
        if (next) follow(*next, tree);
        next = part;
    }
    if (next) branch = *next;
    return next.has_value();
}

// All light that a surface reflects by lobes that are not delta, but for what a ray along the
// diffuse one has to find.
PhotonIntegrator::StillToFind PhotonIntegrator::addReflected(const Surface& surface,
                                                             const Bsdf& bsdf, const Branch& branch,
                                                             const Tree& tree) const {
    const Rgb& throughput = branch.path.throughput;
    StillToFind still;
    if (bsdf.has(Lobe::kDiffuse)) still = readMaps(surface, bsdf, branch, tree);
    still.width = branch.path.footprint.width();
    if (still.indirect && m_maps.lamps)
        sampleCaustics(surface, bsdf, throughput, still.ownRays, tree.sampler, tree.result);
    if (bsdf.reflectsLamps()) {
        const DirectRadiance direct = estimateDirect(
            m_scene, m_lights, surface, bsdf, still.lamps, branch.state.hasMetNoDiffuse(),
            branch.lampSamples, tree.sampler, tree.result.rays);
        for (const Lobe lobe : {Lobe::kDiffuse, Lobe::kGlossy, Lobe::kWide, Lobe::kBroad}) {
            if (!bsdf.has(lobe)) continue;
            PathState by = branch.state;
            by.scatter(lobe);
            if (lobe == Lobe::kDiffuse || !isOfMap(by))
                tree.result.of(by.classify()) += throughput * direct.of(lobe);
        }
    }
    if (m_maps.received) addReceived(surface, bsdf, branch, tree);
    return still;
}

// Caustics by the lobes around a direction, where the path has met no wide one before. Narrow ones
// follow the light of lamps that rays meet; of others they have what came by way of delta lobes
// alone.
void PhotonIntegrator::addReceived(const Surface& surface, const Bsdf& bsdf, const Branch& branch,
                                   const Tree& tree) const {
    if (branch.state.isPastWide) return;
    const Vec3f& ng = bsdf.facingGeometricNormal();
    const float pixelWidth = tree.view.beam.widthAfter(branch.way);
    const Rgb& throughput = branch.path.throughput;
    for (const Lobe lobe : kShinyLobes) {
        if (!bsdf.has(lobe)) continue;
        // Photons tell of light for each area of the surface, by the cosine to the geometric
        // normal.
        constexpr float kLeastCosine = 1e-3f;
        const auto value = [&](const Vec3f& from) {
            return bsdf.evaluate(lobe, from) / std::max(kLeastCosine, std::abs(dot(from, ng)));
        };
        for (const float side : {1.0f, -1.0f}) {
            if (side < 0.0f && !bsdf.goesThrough()) break;
            const ReceivedMap::Place place{surface.position, ng * side, !isWide(lobe), pixelWidth};
            add(m_maps.received->radiance(place, value, tree.scratch), throughput,
                tree.result.caustic, tree.result);
        }
    }
}

PhotonIntegrator::StillToFind PhotonIntegrator::readMaps(const Surface& surface, const Bsdf& bsdf,
                                                         const Branch& branch,
                                                         const Tree& tree) const {
    SampleRadiance& result = tree.result;
    const Rgb reflected = bsdf.reflectedOf(branch.path.throughput);
    StillToFind still;
    GatherPoints::Estimate indirect;
    const Vec3f& normal = bsdf.facingGeometricNormal();
    // What is kept knows where light came from by the surface's admission alone.
    const std::optional<Admission> admission = bsdf.admission();
    const bool isEven = !admission || admission->isEven();
    const GatherPoints::Place place{
        tree.view.screen, surface.position, bsdf.facingShadingNormal(),
        normal,           surface.offset,   isEven ? GatherPoints::kEven : surface.material};
    const bool kept = m_maps.points && admission && m_maps.points->estimate(place, indirect);
    result.rays += indirect.rays;
    if (kept) {
        add(indirect.irradiance, reflected, result.indirect, result);
        if (indirect.lampShare < kLargeLampShare) still.lamps = LampStrategy::kNextEventOnly;
    }
    if (m_maps.caustic) {
        const float pixelWidth = tree.view.beam.widthAfter(branch.way);
        add(m_maps.caustic->irradiance(surface.position, normal, tree.scratch, pixelWidth),
            reflected, result.caustic, result);
    }
    still.indirect = !kept && m_maps.global;
    if (!still.indirect) return still;
    const float share = branch.share * partOf(bsdf, Lobe::kDiffuse);
    still.ownRays = ownGatherRays(m_maps.points, share);
    if (m_maps.refocused) addRefocused(place, indirect.clearance, share, reflected, tree);
    return still;
}

// Where there is no gather point. Such an estimate costs as much as many rays: of what carries
// little few are made.
void PhotonIntegrator::addRefocused(const GatherPoints::Place& place, float clearance, float share,
                                    const Rgb& reflected, const Tree& tree) const {
    const float probability = std::min(1.0f, share / kLeastRefocused);
    Sampler chance = tree.sampler;  // a copy: maps without photons are to change no bit
    if (!(chance.next1D() < probability)) return;
    const std::uint32_t pattern = patternAt(place.position);
    const TwoRadii irradiance =
        m_maps.points ? m_maps.points->refocusedAt(place, clearance, pattern)
                      : m_maps.refocused->at(place.position, place.geometricNormal, pattern);
    add(irradiance, reflected * (1.0f / probability), tree.result.indirect, tree.result);
}

void PhotonIntegrator::followDiffuse(const Surface& surface, const Bsdf& bsdf, const Branch& branch,
                                     StillToFind still, float survival, const Tree& tree) const {
    const Sampler directions = tree.sampler;
    tree.sampler.skip();
    const std::uint32_t rays = still.ownRays;
    const Rgb share = branch.path.throughput / (survival * static_cast<float>(rays));
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
        if (!bsdf.follow(Lobe::kDiffuse, sample, u)) continue;
        const LastScatter last{surface, sample.direction, sample.lobe, sample.pdfSolidAngle,
                               branch.lampSamples};
        const Ray ray = m_scene.rayOnwards(surface.position, bsdf.facingGeometricNormal(),
                                           sample.direction, surface.time);
        gatherAlong(ray, last, still, share * sample.weight / density, rays,
                    dot(sample.direction, bsdf.facingShadingNormal()), part, tree.result);
    }
}

// What is so blurred needs no look at what is met but the irradiance kept there.
void PhotonIntegrator::followBroad(const Surface& surface, const Bsdf& bsdf, const Branch& branch,
                                   float survival, const Tree& tree) const {
    BsdfSample sample;
    if (!bsdf.follow(Lobe::kBroad, sample, tree.sampler.next2D())) return;
    SampleRadiance& result = tree.result;
    const LastScatter last{surface, sample.direction, sample.lobe, sample.pdfSolidAngle,
                           branch.lampSamples};
    const Ray ray = rayFrom(surface, sample.direction);
    const bool findsLamps = !m_scene.viewersDiffer();
    const GatherEnds ends{*m_maps.global,
                          m_maps.lamps,
                          1,
                          &m_lights,
                          true,
                          findsLamps ? &last : nullptr,
                          branch.path.footprint.width(),
                          m_maps.received != nullptr};
    Gathered found = finalGather(m_scene, ends, ray, 1.0f, tree.sampler);
    if (!findsLamps) found.lampsStraight = lightAlong(m_scene, m_lights, ray, last, found.rays);
    result.rays += found.rays;
    const Rgb weight = branch.path.throughput * sample.weight / survival;
    result.indirect += weight * found.radiance.wide;
    result.biasProbe += weight * (found.radiance.narrow - found.radiance.wide);
    PathState state = branch.state;
    state.scatter(sample.lobe);
    result.of(state.classify()) += weight * found.lampsStraight;
}

// What a sample's own gather rays leave out of the light that caustics send straight to a surface.
void PhotonIntegrator::sampleCaustics(const Surface& surface, const Bsdf& bsdf,
                                      const Rgb& throughput, std::uint32_t rays, Sampler sampler,
                                      SampleRadiance& result) const {
    const Vec3f& up = bsdf.facingGeometricNormal();
    const VirtualLamps::Place place{surface.position, surface.position + up * surface.offset,
                                    bsdf.facingShadingNormal(), up,
                                    bsdf.admission().value_or(Admission{})};
    result.rays += VirtualLamps::raysBeside(rays);
    result.indirect +=
        bsdf.reflectedOf(throughput) * m_maps.lamps->sampled(place, rays, sampler.next1D());
}

// Light that the ray finds at a lamp is direct, the other strategy of its next-event estimation;
// light found by way of other lobes is a caustic and its map's business.
void PhotonIntegrator::gatherAlong(const Ray& ray, const LastScatter& last, StillToFind still,
                                   const Rgb& weight, std::uint32_t rays, float cosine,
                                   Sampler& sampler, SampleRadiance& result) const {
    const bool findsLamps = still.lamps == LampStrategy::kBoth;
    const bool aside = !still.indirect || m_scene.viewersDiffer();
    if (findsLamps && aside)
        result.direct += weight * lightAlong(m_scene, m_lights, ray, last, result.rays);
    if (!still.indirect) return;
    const GatherEnds ends{*m_maps.global, m_maps.lamps, rays,
                          &m_lights,      false,        findsLamps && !aside ? &last : nullptr,
                          still.width};
    const Gathered found = finalGather(m_scene, ends, ray, cosine, sampler);
    result.rays += found.rays;
    result.indirect += weight * found.radiance.wide;
    result.biasProbe += weight * (found.radiance.narrow - found.radiance.wide);
    result.direct += weight * found.lampsStraight;
}

}  // namespace pm
