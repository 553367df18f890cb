// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/transport/gather/virtual_lamps.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/partitioner.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <utility>

#include "integrator/materials/bsdf.h"
#include "integrator/paths/segment.h"
#include "integrator/photons/emission/flux_steps.h"
#include "integrator/sampling/sampler.h"
#include "integrator/sampling/warps.h"

namespace pm {

namespace {

constexpr std::size_t kLamps = 2048;
// How far from a lamp, over the distance, its ray may end: more is another surface.
constexpr float kAside = 1e-3f;

}  // namespace

VirtualLamps::VirtualLamps(const Scene& scene, const PhotonMap& caustics, float radius,
                           const SurfacePatches* patches, float radiusFactor, std::uint64_t random,
                           const CancelCheck& cancel, float room)
    : m_scene(scene), m_sites(scene, caustics, radius, patches, radiusFactor, {}, room) {
    const float u = toUnitFloat(static_cast<std::uint32_t>(mixBits(random)));
    const DrawnByFlux drawn = drawBySteps(caustics, kLamps, u, cancel);
    for (const auto& [photon, share] : drawn.photons)
        m_lamps.push_back(
            {photon.position, photon.normal.unpack(), photon.flux * static_cast<float>(1 / share)});
    if (m_lamps.empty()) return;
    m_inverseFlux = static_cast<float>(1 / drawn.flux);
    findDensities(cancel);
}

// The lamps of a site one after the other: in the middle of a caustic its estimate takes up to two
// milliseconds, most lamps are there, and threads that come to it at once would all make it.
void VirtualLamps::findDensities(const CancelCheck& cancel) {
    using OfSite = std::pair<std::uint64_t, std::size_t>;
    std::vector<OfSite> bySite;
    bySite.reserve(m_lamps.size());
    for (std::size_t i = 0; i < m_lamps.size(); ++i)
        bySite.emplace_back(m_sites.siteOf(m_lamps[i].position, m_lamps[i].normal), i);
    std::sort(bySite.begin(), bySite.end());
    std::vector<std::span<const OfSite>> sites;
    for (std::size_t begin = 0, end = 0; begin < bySite.size(); begin = end) {
        while (end < bySite.size() && bySite[end].first == bySite[begin].first) ++end;
        sites.emplace_back(&bySite[begin], end - begin);
    }
    // In the lamps' order, in which those near each other come together.
    std::ranges::sort(sites, {}, [](std::span<const OfSite> site) { return site[0].second; });
    const auto estimate = [&](const tbb::blocked_range<std::size_t>& some) {
        for (std::size_t i = some.begin(); i < some.end(); ++i)
            for (const auto& [site, at] : sites[i]) {
                if (cancel.isSet()) return;
                Lamp& lamp = m_lamps[at];
                lamp.density = densityOf(m_sites.at(lamp.position, lamp.normal).wide);
            }
    };
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, sites.size()), estimate,
                      tbb::simple_partitioner());
    cancel.throwIfSet("making lamps of caustics");
}

TwoRadii VirtualLamps::gathered(const Vec3f& position, const Vec3f& normal, float density,
                                std::uint32_t gatherRays) const {
    if (m_lamps.empty()) return {};
    TwoRadii irradiance = m_sites.at(position, normal);
    const float byLamps = static_cast<float>(raysBeside(gatherRays)) * densityOf(irradiance.wide);
    if (!(byLamps > 0.0f)) return irradiance;
    const float weight = 1.0f / (1.0f + byLamps / (static_cast<float>(gatherRays) * density));
    return {irradiance.wide * weight, irradiance.narrow * weight};
}

// The surface at a place, as a ray meets it that goes there, straight on through what lets it pass;
// and the share of light that comes from there. False: something is in the way.
bool VirtualLamps::reach(const Ray& ray, const Vec3f& place, float tolerance, Surface& met,
                         Rgb& share) const {
    const CacheWatch::As as(CacheUser::kShadow);
    bool isReached = false;
    goStraight(
        m_scene, ray, m_scene.coneAround(ray.direction),
        [&](const Surface* surface, const Rgb& left) {
            isReached =
                surface && lengthSquared(surface->position - place) <= tolerance * tolerance;
            if (!isReached) return true;
            met = *surface;
            share = left;
            return false;
        },
        [](const Surface&) { return false; });
    return isReached;
}

// What a lamp brings alone, weighted.
Rgb VirtualLamps::irradianceBy(const Lamp& lamp, const Place& place,
                               std::uint32_t gatherRays) const {
    const Vec3f away = lamp.position - place.position;
    const float height = dot(away, place.shadingNormal);
    if (!(height > 0.0f && dot(away, place.geometricNormal) > 0.0f &&
          dot(away, lamp.normal) < 0.0f && lamp.density > 0.0f))
        return {};
    const Vec3f way = lamp.position - place.start;
    const float wayLength = length(way);
    const Ray ray{place.start, way * (1.0f / wayLength), wayLength * (1.0f + kAside)};
    Surface met;
    Rgb share;
    if (!reach(ray, lamp.position, kAside * wayLength, met, share)) return {};
    const Bsdf bsdf(m_scene.materials(), met, -ray.direction, Transport::kRadiance, Rgb(1.0f));
    const float facing = -dot(away, bsdf.facingGeometricNormal());
    const float squared = lengthSquared(away);
    // Of gather rays by the cosine, for each unit of area there.
    const float density = (height / squared) * (facing / squared) * kInvPi;
    const auto gather = static_cast<float>(gatherRays);
    const float own = static_cast<float>(raysBeside(gatherRays)) * lamp.density;
    // density * own / (own + gather * density), also where the density is beyond all floats.
    return lamp.flux * bsdf.diffuse() *
           (share * place.admission.from(height / std::sqrt(squared))) *
           (facing > 0.0f ? own / (own / density + gather) : 0.0f);
}

Rgb VirtualLamps::sampled(const Place& place, std::uint32_t gatherRays, float u) const {
    Rgb sum;
    if (m_lamps.empty()) return sum;
    const std::uint32_t rays = raysBeside(gatherRays);
    const double step = static_cast<double>(m_lamps.size()) / rays;
    for (std::uint32_t i = 0; i < rays; ++i)
        sum += irradianceBy(m_lamps[static_cast<std::size_t>((i + static_cast<double>(u)) * step)],
                            place, gatherRays);
    return sum / static_cast<float>(rays);
}

std::uint64_t VirtualLamps::memoryBytes() const {
    return m_sites.memoryBytes() + m_lamps.size() * sizeof(Lamp);
}

std::uint64_t VirtualLamps::memoryBytes(std::uint64_t photons, float radiusFactor, float room) {
    return IrradianceSites::memoryBytes(photons, radiusFactor, room) + kLamps * sizeof(Lamp);
}

}  // namespace pm
