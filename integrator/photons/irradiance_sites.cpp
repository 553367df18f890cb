// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/photons/irradiance_sites.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "integrator/sampling/sampler.h"
#include "integrator/sampling/warps.h"

namespace pm {

namespace {

// The rays start this far above the site, in radii: low enough to see little else than the disc.
constexpr float kApexHeight = 0.3f;
// A ray has found the surface when it meets it within this of the disc's point, in radii: room for
// surfaces that curve away.
constexpr float kMissDistance = 0.4f;
// Rays to the rim; where all of them find the surface, the disc is taken as whole.
constexpr std::uint32_t kRimRays = 8;
constexpr std::uint32_t kAreaRays = 32;
// The share of the disc in the sharpest corner that is still told apart; a square one has 1/4.
constexpr float kSmallestShare = 0.1f;
// A site farther away than this, in radii, says too little about a point. Where light is, about
// twelve sites share a disc of one radius; where it is not, bright values from across a shadow's
// edge must not be taken for the dark one's.
constexpr float kSiteReach = 0.6f;
// Cosine of how far the surface may turn away within the disc; as the map's photons.
constexpr float kNormalCosine = 0.9f;

}  // namespace

IrradianceSites::IrradianceSites(const Scene& scene, const PhotonMap& map,
                                 std::vector<Photon> sites, float radius)
    : m_scene(scene),
      m_map(map),
      m_sites(std::move(sites)),
      m_kept(std::make_unique<Kept[]>(m_sites.size())),
      m_radius(radius) {}

bool IrradianceSites::onSurface(const Vec3f& position, const Vec3f& normal,
                                const Vec3f& inPlane) const {
    const Vec3f apex = position + normal * (kApexHeight * m_radius);
    const Vec3f target = position + inPlane;
    Surface surface;
    if (!m_scene.intersect({apex, target - apex, 1.0f + kMissDistance}, surface)) return false;
    return std::abs(dot(surface.geometricNormal, normal)) >= kNormalCosine &&
           lengthSquared(surface.position - target) <=
               kMissDistance * kMissDistance * m_radius * m_radius;
}

float IrradianceSites::surfaceShare(const Vec3f& position, const Vec3f& normal,
                                    std::uint32_t pattern) const {
    const Frame frame(normal);
    const float turn = toUnitFloat(static_cast<std::uint32_t>(mixBits(pattern)));
    const auto probe = [&](float turns, float radius) {
        const SinCos phi = sinCosTurns(turns - std::floor(turns));
        return onSurface(
            position, normal,
            (frame.tangent * phi.cos + frame.bitangent * phi.sin) * (radius * m_radius));
    };
    std::uint32_t found = 0;
    for (std::uint32_t i = 0; i < kRimRays; ++i)
        found += probe(turn + static_cast<float>(i) / kRimRays, 0.95f);
    if (found == kRimRays) return 1.0f;
    // Equal areas on a golden spiral (Vogel 1979).
    constexpr float kGoldenTurn = 0.381966011f;
    found = 0;
    for (std::uint32_t i = 0; i < kAreaRays; ++i)
        found += probe(turn + kGoldenTurn * static_cast<float>(i),
                       std::sqrt((static_cast<float>(i) + 0.5f) / kAreaRays));
    return std::max(kSmallestShare, static_cast<float>(found) / kAreaRays);
}

Rgb IrradianceSites::estimate(const Vec3f& position, const Vec3f& normal,
                              std::uint32_t pattern) const {
    const float discArea = kPi * m_radius * m_radius;
    const float share = surfaceShare(position, normal, pattern);
    if (share == 1.0f) return m_map.fluxWithin(position, normal, m_radius) / discArea;
    const Vec3f apex = position + normal * (kApexHeight * m_radius);
    const Rgb flux = m_map.fluxWithin(position, normal, m_radius, [&](const Photon& photon) {
        // Ends a little above the photon, whose own surface must not hide it.
        const Vec3f above = photon.position + photon.normal.unpack() * (0.01f * m_radius);
        return !m_scene.occluded({apex, above - apex, 1.0f});
    });
    return flux / (discArea * share);
}

Rgb IrradianceSites::at(const Vec3f& position, const Vec3f& normal, NearestPhotons& scratch) const {
    m_sites.findNearest({position, normal, 1, kSiteReach * m_radius}, scratch);
    if (scratch.found().empty()) {
        // Any pattern that depends on the point alone.
        const auto pattern = std::bit_cast<std::uint32_t>(position.x) ^
                             std::bit_cast<std::uint32_t>(position.y + position.z);
        return estimate(position, normal, pattern);
    }
    const std::uint32_t index = scratch.found().front().index;
    Kept& kept = m_kept[index];
    if (kept.ready.load(std::memory_order_acquire))
        return {kept.r.load(std::memory_order_relaxed), kept.g.load(std::memory_order_relaxed),
                kept.b.load(std::memory_order_relaxed)};
    // Two threads may both come here: they compute and store the same bits.
    const Photon& site = m_sites.photon(index);
    const Rgb value = estimate(site.position, site.normal.unpack(), index);
    kept.r.store(value.r, std::memory_order_relaxed);
    kept.g.store(value.g, std::memory_order_relaxed);
    kept.b.store(value.b, std::memory_order_relaxed);
    kept.ready.store(1, std::memory_order_release);
    return value;
}

std::uint64_t IrradianceSites::memoryBytes() const {
    return m_sites.memoryBytes() + m_sites.size() * sizeof(Kept);
}

}  // namespace pm
