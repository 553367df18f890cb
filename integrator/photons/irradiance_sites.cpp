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

// The rays start this far above the site, in radii: high enough to see a hollow's whole disc, low
// enough to see little else.
constexpr float kApexHeight = 0.6f;
// What starts or ends on a surface is lifted off it by this share of the length it has to go.
constexpr float kLift = 0.01f;
// A ray goes on this far beyond the disc's point, relative to the way there: room for surfaces that
// curve away.
constexpr float kRayReach = 1.5f;
// The spiral's rays: the first kDiscRays go to equal parts of the disc, the others beyond its rim.
constexpr std::uint32_t kAreaRays = 48, kDiscRays = 24;
// Grazing rays see much surface each; more than this is cut, so that one ray can't decide the area.
constexpr float kLargestAreaRatio = 4.0f;
constexpr float kFlatTolerance = 0.02f;
// Rays to the rim; where all of them find it flat, the disc is taken as whole.
constexpr std::uint32_t kRimRays = 8;
// The share of the disc in the sharpest corner that is still told apart; a square one has 1/4.
constexpr float kSmallestShare = 0.1f;
// A site farther away than this, in radii, says too little about a point. Where light is, some
// twenty sites share a disc of one radius; where it is not, bright values from across a shadow's
// edge must not be taken for the dark one's.
constexpr float kSiteReach = 0.6f;

}  // namespace

IrradianceSites::IrradianceSites(const Scene& scene, const PhotonMap& map,
                                 std::vector<Photon> sites, float radius)
    : m_scene(scene),
      m_map(map),
      m_sites(std::move(sites)),
      m_kept(std::make_unique<Kept[]>(m_sites.size())),
      m_radius(radius) {}

// Area of surface that a unit of the disc's plane at `inPlane` stands for, seen from the apex: 0
// where there is none whose photons the map would count, 1 where the surface is the plane.
float IrradianceSites::areaSeen(const Vec3f& position, const Vec3f& normal, float apexHeight,
                                const Vec3f& inPlane) const {
    const Vec3f apex = position + normal * apexHeight;
    const Vec3f ray = position + inPlane - apex;
    Surface surface;
    if (!m_scene.intersect({apex, ray, kRayReach}, surface)) return 0.0f;
    const MaterialDescription& material = m_scene.material(surface.material);
    if (material.kind != MaterialKind::kSurface || isBlack(material.diffuse)) return 0.0f;
    const Vec3f facing = dot(surface.geometricNormal, ray) < 0.0f ? surface.geometricNormal
                                                                  : -surface.geometricNormal;
    const Vec3f fromSite = surface.position - position;
    if (!m_map.accepts(fromSite, facing, normal) || lengthSquared(fromSite) > m_radius * m_radius)
        return 0.0f;
    // Solid angle is kept: dA cos / d^2 is the same on the plane and on the surface.
    const float onPlane = -dot(ray, normal) / lengthSquared(ray);
    const Vec3f seen = surface.position - apex;
    const float onSurface = -dot(seen, facing) / lengthSquared(seen);
    const float ratio =
        onPlane * std::sqrt(lengthSquared(seen)) / (onSurface * std::sqrt(lengthSquared(ray)));
    return std::min(ratio, kLargestAreaRatio);
}

float IrradianceSites::surfaceShare(const Vec3f& position, const Vec3f& normal, float apexHeight,
                                    std::uint32_t pattern) const {
    const Frame frame(normal);
    const float turn = toUnitFloat(static_cast<std::uint32_t>(mixBits(pattern)));
    const auto probe = [&](float turns, float radius) {
        const SinCos phi = sinCosTurns(turns - std::floor(turns));
        return areaSeen(
            position, normal, apexHeight,
            (frame.tangent * phi.cos + frame.bitangent * phi.sin) * (radius * m_radius));
    };
    std::uint32_t flat = 0;
    for (std::uint32_t i = 0; i < kRimRays; ++i) {
        const float area = probe(turn + static_cast<float>(i) / kRimRays, 0.95f);
        flat += std::abs(area - 1.0f) < kFlatTolerance;
    }
    if (flat == kRimRays) return 1.0f;
    // Equal areas on a golden spiral (Vogel 1979), wider than the disc: where the surface bends
    // towards the apex its part within the radius is seen beyond the disc's rim.
    constexpr float kGoldenTurn = 0.381966011f;
    float sum = 0.0f;
    for (std::uint32_t i = 0; i < kAreaRays; ++i)
        sum += probe(turn + kGoldenTurn * static_cast<float>(i),
                     std::sqrt((static_cast<float>(i) + 0.5f) / kDiscRays));
    return std::max(kSmallestShare, sum / kDiscRays);
}

// Above the site, half as high as whatever stands there: under a ball on the floor the apex must
// not be inside the ball.
float IrradianceSites::apexHeight(const Vec3f& position, const Vec3f& normal) const {
    const float height = kApexHeight * m_radius;
    const Vec3f start = position + normal * (kLift * m_radius);
    Surface above;
    if (!m_scene.intersect({start, normal, 2.0f * height}, above)) return height;
    return std::min(height, 0.5f * dot(above.position - position, normal));
}

Rgb IrradianceSites::estimate(const Vec3f& position, const Vec3f& normal,
                              std::uint32_t pattern) const {
    const float discArea = kPi * m_radius * m_radius;
    const float height = apexHeight(position, normal);
    const float share = surfaceShare(position, normal, height, pattern);
    if (share == 1.0f) return m_map.fluxWithin(position, normal, m_radius) / discArea;
    const Vec3f apex = position + normal * height;
    const Rgb flux = m_map.fluxWithin(position, normal, m_radius, [&](const Photon& photon) {
        // Ends a little above the photon, whose own surface must not hide it.
        const Vec3f above = photon.position + photon.normal.unpack() * (kLift * height);
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
