// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/transport/photon/photon_path.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numbers>
#include <optional>

#include "integrator/transport/gather/final_gather.h"

namespace pm {

namespace {

// Of the lobes of a surface, camera paths follow all those that carry this or more, 1 where they
// begin.
constexpr float kLeastDivided = 0.03f;

bool hasSeveralLobes(const Bsdf& bsdf) {
    int lobes = 0;
    for (std::size_t i = 0; i < kLobeCount; ++i) lobes += bsdf.has(static_cast<Lobe>(i));
    return lobes > 1;
}

// Of each lobe, with which probability the path was to be followed along it; 0: it is not.
using Survival = std::array<float, kLobeCount>;

// Chosen by chance, what glass reflects, a few per cent, would be grain in all that is seen through
// it. So all lobes that carry enough are followed, and of those that carry less, few with more.
// Systematic sampling: their probabilities laid end to end from a random start, those are followed
// that reach a whole number. diffuse: whether that lobe is one to follow.
Survival divide(const Bsdf& bsdf, const CameraStep& path, bool diffuse) {
    const bool several = hasSeveralLobes(bsdf);
    Survival survival{};
    for (std::size_t i = 0; i < kLobeCount; ++i) {
        const auto lobe = static_cast<Lobe>(i);
        if (!bsdf.has(lobe) || (lobe == Lobe::kDiffuse && !diffuse)) continue;
        const float amount = maxChannel(path.carried * bsdf.reflectance(lobe)) * path.etaScale;
        survival[i] = several ? std::min(1.0f, amount / kLeastDivided) : 1.0f;
    }
    if (!several) return survival;
    double end = path.random.get1D(Purpose::kLobe);
    for (float& probability : survival) {
        const double begin = end;
        end += probability;
        if (std::floor(begin) == std::floor(end)) probability = 0.0f;
    }
    return survival;
}

}  // namespace

// What their noise comes to goes with the share's square, so for its time it is
// least where their number goes with the share: to the nearest power of two.
std::uint32_t PhotonPath::raysOfShare(std::uint32_t rays, float share) {
    constexpr float kSqrt2 = std::numbers::sqrt2_v<float>;
    const float worth = std::min(kSqrt2 * share, 1.0f) * static_cast<float>(rays);
    return std::bit_floor(std::max(1u, static_cast<std::uint32_t>(worth)));
}

float PhotonPath::partOf(const Bsdf& bsdf, Lobe lobe) {
    if (bsdf.isDiffuseOnly()) return 1.0f;
    float all = 0.0f;
    for (std::size_t i = 0; i < kLobeCount; ++i)
        all += maxChannel(bsdf.reflectance(static_cast<Lobe>(i)));
    return all > 0.0f ? maxChannel(bsdf.reflectance(lobe)) / all : 0.0f;
}

// Where shadow rays don't meet what others do.
void PhotonPath::addLampsAlong(PhotonBranch& branch) {
    if (!m_scene.viewersDiffer() || isDelta(branch.last.lobe) || branch.last.hasLamps) return;
    if (!isOfMap(branch.state))
        m_result.of(branch.state.classify()) +=
            branch.carried * lightAlong(m_scene, m_lights, branch.ray, branch.last, m_result.rays);
    branch.last.hasLamps = true;
}

// Along all lobes; by the last one that leads on `branch` itself.
bool PhotonPath::followLobes(const Surface& surface, const Bsdf& bsdf, StillToFind still,
                             PhotonBranch& branch, Waiting<PhotonBranch>& waiting) {
    const Survival survival = divide(bsdf, branch, still.any());
    // A path that goes on by one lobe, beside those that end it, has lost the rest.
    const auto goesOn = [&](Lobe lobe) {
        return lobe != Lobe::kDiffuse && !(lobe == Lobe::kBroad && m_maps.global);
    };
    int waysOn = 0;
    for (std::size_t i = 0; i < kLobeCount; ++i)
        waysOn += survival[i] > 0.0f && goesOn(static_cast<Lobe>(i));
    const PhotonBranch arrived = branch;
    bool isFollowed = false;
    const auto follow = [&](PhotonBranch part, Lobe lobe, float probability, bool isPart) {
        if (!goOn(part, surface, bsdf, lobe, probability, isPart)) return;
        if (isFollowed) waiting.add(branch);
        branch = part;
        isFollowed = true;
    };
    for (std::size_t i = 0; i < kLobeCount; ++i) {
        if (survival[i] == 0.0f) continue;
        const auto lobe = static_cast<Lobe>(i);
        if (lobe == Lobe::kDiffuse) {
            followDiffuse(surface, bsdf, arrived, still, survival[i]);
            continue;
        }
        const std::uint32_t parts = partsAlong(arrived, bsdf, lobe);
        if (!goesOn(lobe)) {
            const Sampler all = arrived.random.branch(static_cast<std::uint32_t>(lobe));
            for (std::uint32_t k = 0; k < parts; ++k)
                followBroad(surface, bsdf, arrived, survival[i] * static_cast<float>(parts),
                            all.part(parts, k));
            continue;
        }
        const bool isPart = waysOn > 1 || parts > 1;
        PhotonBranch part = arrived;
        part.parts *= parts;
        if (isPart) part.random = arrived.random.branch(static_cast<std::uint32_t>(lobe));
        const Sampler all = part.random;
        for (std::uint32_t k = 0; k < parts; ++k) {
            if (parts > 1) part.random = all.part(parts, k);
            follow(part, lobe, survival[i] * static_cast<float>(parts), isPart);
        }
    }
    return isFollowed;
}

// Through rough glass and in rough metal a lamp, or what it lights most, is a glint that few paths
// find: of all that the camera sample brings several are worth their time, as they share what led
// there. And weights of samples, one after the other within rough glass, would leave in one path
// what is the light of many: it divides into those.
std::uint32_t PhotonPath::partsAlong(const PhotonBranch& branch, const Bsdf& bsdf, Lobe lobe) {
    constexpr float kMost = 0.5f, kMostExcess = 2.0f;
    constexpr std::uint32_t kReflected = 4, kThrough = 16, kMostParts = 256;
    if (isDelta(lobe)) return 1;
    if (branch.share * partOf(bsdf, lobe) > kMost)
        return bsdf.goesThrough() ? kThrough : kReflected;
    // What is caught in glass for long would divide without end.
    if (branch.excess() < kMostExcess || branch.parts >= kMostParts) return 1;
    const float excess = std::min(branch.excess(), static_cast<float>(kMostParts / branch.parts));
    return std::bit_floor(static_cast<std::uint32_t>(excess));
}

bool PhotonPath::goOn(PhotonBranch& branch, const Surface& surface, const Bsdf& bsdf, Lobe lobe,
                      float survival, bool isPart) {
    BsdfSample sample;
    if (!bsdf.follow(lobe, sample, isDelta(lobe) ? LobeNumbers{} : lobeNumbers(branch.random)))
        return false;
    sample.weight *= 1.0f / survival;
    branch.share *= partOf(bsdf, lobe) / survival;
    if (!branch.scatter(surface, bsdf, sample, isPart)) {
        if (branch.isCut()) m_result.addCut(branch.amount());
        return false;
    }
    if (sample.lobe != Lobe::kStraight) {
        branch.state.scatter(sample.lobe, bsdf.isFrosted());
        branch.last = lastScatter(surface, sample, branch.lampSamples);
    }
    addLampsAlong(branch);
    branch.lampSamples = bsdf.reflectsLamps() ? 1
                                              : std::min(branch.lampSamples,
                                                         raysOfShare(m_lampSamples, branch.share));
    return true;
}

void PhotonPath::followDiffuse(const Surface& surface, const Bsdf& bsdf, const PhotonBranch& branch,
                               StillToFind still, float survival) {
    const Sampler directions = branch.random.branch(static_cast<std::uint32_t>(Lobe::kDiffuse));
    const std::uint32_t rays = still.ownRays;
    const Rgb share = branch.carried / (survival * static_cast<float>(rays));
    std::optional<GatherGuide::Directions> guide;
    // For lamps that such rays meet, too: the weights of the two strategies sum to 1 in every
    // direction, by whichever density the rays come.
    if (still.indirect && m_maps.points)
        guide = m_maps.points->directionsAt(surface.position, Frame(bsdf.facingShadingNormal()));
    for (std::uint32_t i = 0; i < rays; ++i) {
        // All those of a pixel are one low-discrepancy sequence.
        Sampler part = directions.part(rays, i);
        BsdfSample sample;
        const auto [u, density] = GatherGuide::warp(guide, part.get2D(Purpose::kDirection));
        part.nextEvent();
        if (!bsdf.follow(Lobe::kDiffuse, sample, {u, 0.0f})) continue;
        const LastScatter last{surface, sample.direction, sample.lobe, sample.pdfSolidAngle,
                               branch.lampSamples};
        const Ray ray = m_scene.rayOnwards(surface.position, bsdf.facingGeometricNormal(),
                                           sample.direction, surface.time);
        gatherAlong(ray, last, still, share * sample.weight / density, rays,
                    dot(sample.direction, bsdf.facingShadingNormal()), part);
    }
}

// What is so blurred needs no look at what is met but the irradiance kept there.
void PhotonPath::followBroad(const Surface& surface, const Bsdf& bsdf, const PhotonBranch& branch,
                             float survival, Sampler random) {
    BsdfSample sample;
    if (!bsdf.follow(Lobe::kBroad, sample, lobeNumbers(random))) return;
    random.nextEvent();
    SampleRadiance& result = m_result;
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
                          branch.footprint.width(),
                          true,
                          m_maps.received != nullptr};
    Gathered found = finalGather(m_scene, ends, ray, 1.0f, random);
    if (!findsLamps) found.lampsStraight = lightAlong(m_scene, m_lights, ray, last, found.rays);
    result.rays += found.rays;
    const Rgb weight = branch.carried * sample.weight / survival;
    result.indirect += weight * found.radiance.wide;
    result.biasProbe += weight * (found.radiance.narrow - found.radiance.wide);
    result.of(branch.state.after(sample.lobe, false).classify()) += weight * found.lampsStraight;
}

// Light that the ray finds at a lamp is direct, the other strategy of its next-event estimation;
// light found by way of other lobes is a caustic and its map's business.
void PhotonPath::gatherAlong(const Ray& ray, const LastScatter& last, StillToFind still,
                             const Rgb& weight, std::uint32_t rays, float cosine,
                             const Sampler& sampler) {
    SampleRadiance& result = m_result;
    const bool findsLamps = still.lamps == DirectStrategy::kBoth;
    const bool aside = !still.indirect || m_scene.viewersDiffer();
    if (findsLamps && aside)
        result.direct += weight * lightAlong(m_scene, m_lights, ray, last, result.rays);
    if (!still.indirect) return;
    const GatherEnds ends{*m_maps.global, m_maps.lamps,
                          rays,           &m_lights,
                          false,          findsLamps && !aside ? &last : nullptr,
                          still.width,    !m_maps.refocused};
    const Gathered found = finalGather(m_scene, ends, ray, cosine, sampler);
    result.rays += found.rays;
    result.indirect += weight * found.radiance.wide;
    result.biasProbe += weight * (found.radiance.narrow - found.radiance.wide);
    result.direct += weight * found.lampsStraight;
}

}  // namespace pm
