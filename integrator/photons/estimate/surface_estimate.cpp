// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/photons/estimate/surface_estimate.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "integrator/photons/estimate/surface_patches.h"
#include "integrator/sampling/sampler.h"
#include "integrator/sampling/warps.h"

namespace pm {

namespace {

// The rays start this far above the point, in radii: high enough to see a hollow's whole disc, low
// enough to see little else.
constexpr float kApexHeight = 0.6f;
// A ray goes on this far beyond the disc's point, relative to the way there: room for surfaces that
// curve away.
constexpr float kRayReach = 1.5f;
// Grazing rays see much surface each; more than this is cut, so that one ray can't decide the area.
constexpr float kLargestAreaRatio = 4.0f;
// Where less of the disc than this is surface (a leaf, a wire) it is too wide for what is there: it
// is halved, so many times at most. By what stands there alone: photons that chose their own radius
// would bias it.
constexpr float kLeastShare = 0.2f;
constexpr int kMostHalvings = 6;
// What sees nothing looks from so far aside, in radii.
constexpr float kAside = 0.125f;
constexpr float kFlatTolerance = 0.02f;
// Rays beyond the rim, at kRim radii; where all of them find it flat, the disc is taken as whole.
// No straight wall that cuts the disc passes between two of them: kRim cos(pi / kRimRays) > 1.
constexpr std::uint32_t kRimRays = 8;
constexpr float kRim = 1.09f;

// Where area is looked for: the narrow disc, the ring around it, and beyond the rim, where surface
// that bends towards the apex is seen that lies within the radius. Squared, in radii.
struct Zone {
    float from, to;
    std::uint32_t rays;
};
constexpr std::array<Zone, 4> kZones{
    {{0.0f, 0.5f, 18}, {0.5f, 1.0f, 12}, {1.0f, 1.3f, 5}, {1.3f, 2.0f, 5}}};

}  // namespace

SeenArea lookFor(const Scene& scene, const PhotonGate& gate, const Vec3f& apex,
                 const Vec3f& inPlane, bool ofGlossy) {
    const Vec3f ray = gate.position + inPlane - apex;
    Surface surface;
    if (!scene.meet({apex, ray, kRayReach}, surface)) return {};
    const MaterialTraits& traits = scene.traits(surface.material);
    if (!(ofGlossy ? traits.isGlossy : traits.isDiffuse)) return {};
    const Vec3f facing = dot(surface.geometricNormal, ray) < 0.0f ? surface.geometricNormal
                                                                  : -surface.geometricNormal;
    const Vec3f fromPoint = surface.position - gate.position;
    if (!gate.accepts(fromPoint, facing)) return {};
    // Solid angle is kept: dA cos / d^2 is the same on the plane and on the surface.
    const float onPlane = -dot(ray, gate.normal) / lengthSquared(ray);
    const Vec3f seen = surface.position - apex;
    const float onSurface = -dot(seen, facing) / lengthSquared(seen);
    const float ratio =
        onPlane * std::sqrt(lengthSquared(seen)) / (onSurface * std::sqrt(lengthSquared(ray)));
    return {std::min(ratio, kLargestAreaRatio), fromPoint, facing};
}

float apexHeight(const Scene& scene, const Vec3f& position, const Vec3f& normal, float radius) {
    const float height = kApexHeight * radius;
    // Off the surface itself, but below a ball as close to where it touches as can be told.
    const Vec3f start = position + normal * scene.liftOfPoints(position);
    Surface above;
    if (!scene.meet({start, normal, 2.0f * height}, above)) return height;
    return std::min(height, 0.5f * dot(above.position - position, normal));
}

bool isSeenFrom(const Scene& scene, const Vec3f& apex, const Vec3f& position, const Vec3f& normal) {
    const Vec3f way = position + normal * scene.liftOfPoints(position) - apex;
    const float distance = length(way);
    return !(distance > 0.0f) || !scene.occluded({apex, way * (1.0f / distance), distance});
}

std::uint32_t patternAt(const Vec3f& position, float radius) {
    // Of the radius. Walls at round coordinates are not to lie where cells meet.
    constexpr float kCell = 1.0f / 256.0f, kShift = 0.37f;
    const auto cell = [&](float x) {
        return std::bit_cast<std::uint32_t>(std::floor(x / (kCell * radius) + kShift));
    };
    return static_cast<std::uint32_t>(
        combineBits(std::uint64_t{cell(position.x)} << 32 | cell(position.y), cell(position.z)));
}

SeenArea SurfaceEstimate::lookAt(const View& view, float turns, float radii) const {
    const SinCos phi = sinCosTurns(turns - std::floor(turns));
    const Vec3f inPlane = (view.tangent * phi.cos + view.bitangent * phi.sin) * (radii * m_radius);
    return lookFor(m_scene, m_map.gate(view.position, view.normal), view.apex, inPlane,
                   m_weights != nullptr);
}

SurfaceEstimate::Seen SurfaceEstimate::look(const View& view, float turns,
                                            float radiusSquared) const {
    const SeenArea seen = lookAt(view, turns, std::sqrt(radiusSquared));
    const float distanceSquared = lengthSquared(seen.fromPoint);
    if (distanceSquared > m_radius * m_radius) return {};
    return {seen.area, distanceSquared};
}

bool SurfaceEstimate::isWhole(const View& view, bool& isPlane) const {
    isPlane = true;
    for (std::uint32_t i = 0; i < kRimRays; ++i) {
        // Opposite sides first: an edge is on one of them.
        const std::uint32_t j = (i % 2) * (kRimRays / 2) + i / 2;
        const SeenArea seen = lookAt(view, view.turn + static_cast<float>(j) / kRimRays, kRim);
        if (!(std::abs(seen.area - 1.0f) < kFlatTolerance)) return false;
        isPlane = isPlane && m_map.gate(view.position, view.normal).isInPlane(seen.fromPoint);
    }
    return true;
}

SurfaceEstimate::Shares SurfaceEstimate::shares(const View& view) const {
    // Equal areas on a golden spiral (Vogel 1979) in each zone. Moved along with the turn: at fixed
    // radii the rim of a bent disc would always fall between the same two.
    constexpr float kGoldenTurn = 0.381966011f;
    float wide = 0.0f, narrow = 0.0f, ray = 0.0f;
    for (const Zone& zone : kZones) {
        const float areaOfRay = (zone.to - zone.from) / static_cast<float>(zone.rays);
        for (std::uint32_t i = 0; i < zone.rays; ++i, ++ray) {
            const Seen seen = look(view, view.turn + kGoldenTurn * ray,
                                   zone.from + (static_cast<float>(i) + view.shift) * areaOfRay);
            wide += seen.area * areaOfRay;
            if (seen.distanceSquared <= 0.5f * m_radius * m_radius) narrow += seen.area * areaOfRay;
        }
    }
    return {wide, 2.0f * narrow};
}

// Flux over the area that is surface.
TwoRadii SurfaceEstimate::irradiance(const TwoRadii& flux, const Shares& share) const {
    const float discArea = kPi * m_radius * m_radius;
    return {flux.wide / (discArea * std::max(kSmallestShare, share.wide)),
            flux.narrow / (0.5f * discArea * std::max(kSmallestShare, share.narrow))};
}

// Of all photons, or of those that are seen from the apex, by their weights.
TwoRadii SurfaceEstimate::weighted(const Vec3f& position, const Vec3f& normal, float radius,
                                   const Vec3f* apex) const {
    TwoRadii sum;
    const float narrow = 0.5f * radius * radius;
    m_map.visitAccepted(
        position, normal, radius, m_weights->scratch,
        [&](std::uint32_t index, float distanceSquared) {
            const Rgb weight = m_weights->of(index);
            if (isBlack(weight)) return;
            if (apex) {
                const Photon photon = m_map.photon(index);
                if (!isSeenFrom(m_scene, *apex, photon.position, photon.normal.unpack())) return;
            }
            sum.wide += weight;
            if (distanceSquared <= narrow) sum.narrow += weight;
        });
    return sum;
}

TwoRadii SurfaceEstimate::fluxWithin(const Vec3f& position, const Vec3f& normal,
                                     float radius) const {
    return m_weights ? weighted(position, normal, radius, nullptr)
                     : m_map.fluxWithin(position, normal, radius);
}

// Of the photons that are seen from above the point.
TwoRadii SurfaceEstimate::fluxSeen(const View& view) const {
    if (m_weights) return weighted(view.position, view.normal, m_radius, &view.apex);
    return m_map.fluxWithin(view.position, view.normal, m_radius, [&](std::uint32_t index) {
        const Photon photon = m_map.photon(index);
        return isSeenFrom(m_scene, view.apex, photon.position, photon.normal.unpack());
    });
}

TwoRadii SurfaceEstimate::at(const Vec3f& position, const Vec3f& normal,
                             std::uint32_t pattern) const {
    // In the dark there is nothing to correct.
    const TwoRadii flux = fluxWithin(position, normal, m_radius);
    if (isBlack(flux.wide)) return {};
    if (const auto seen = ofWhatIsSeen(position, normal, pattern, flux, 0)) return *seen;
    return beside(position, normal, pattern);
}

// Where a ball touches the floor, in a gap that is lost in roundings, nothing is seen, but a little
// aside it is. Black where that sees nothing, either: inside of something that stands there.
TwoRadii SurfaceEstimate::beside(const Vec3f& position, const Vec3f& normal,
                                 std::uint32_t pattern) const {
    const Frame frame(normal);
    for (const Vec3f& aside : {frame.tangent, frame.bitangent, -frame.tangent, -frame.bitangent}) {
        const Vec3f place = position + aside * (kAside * m_radius);
        const TwoRadii flux = fluxWithin(place, normal, m_radius);
        if (const auto seen = ofWhatIsSeen(place, normal, pattern, flux, 0)) return *seen;
    }
    return {};
}

// Nothing where no surface is seen. flux: of all photons within the radius. halvings: of the first
// radius so far.
std::optional<TwoRadii> SurfaceEstimate::ofWhatIsSeen(const Vec3f& position, const Vec3f& normal,
                                                      std::uint32_t pattern, const TwoRadii& flux,
                                                      int halvings) const {
    const float least = halvings < kMostHalvings ? kLeastShare : 0.0f;
    TwoRadii counted = flux;
    std::optional<Shares> share;
    if (m_patches) share = askPatch(position, normal, counted);
    if (!share || share->wide < least) {
        counted = flux;
        share = askRays(position, normal, pattern, least, counted);
    }
    const bool sawAny = share->wide > 0.0f;
    if (sawAny && share->wide >= least) return irradiance(counted, *share);
    if (halvings == kMostHalvings) return std::nullopt;
    // Patches don't tell apart what is so small.
    SurfaceEstimate nearer(m_scene, m_map, 0.5f * m_radius);
    nearer.m_weights = m_weights;
    const TwoRadii fluxNearer = fluxWithin(position, normal, nearer.m_radius);
    const auto seen = isBlack(fluxNearer.wide) ? std::nullopt
                                               : nearer.ofWhatIsSeen(position, normal, pattern,
                                                                     fluxNearer, halvings + 1);
    // No photon where something is seen: dark.
    return !seen && sawAny ? TwoRadii{} : seen;
}

// Nothing where the patch there doesn't speak for the point. flux: becomes that of the photons that
// count.
std::optional<SurfaceEstimate::Shares> SurfaceEstimate::askPatch(const Vec3f& position,
                                                                 const Vec3f& normal,
                                                                 TwoRadii& flux) const {
    SurfacePatch spare;
    const SurfacePatch& patch = m_patches->at(position, normal, m_radius, spare);
    if (!patch.speaksFor(m_scene, position, normal, m_radius)) return std::nullopt;
    const SurfacePatch::Shares shares = patch.shares(position, m_radius);
    flux = patch.countedFlux(m_scene, m_map, position, normal, m_radius, flux);
    return Shares{shares.wide, shares.narrow};
}

// flux: as of askPatch, where at least the `least` share is surface.
SurfaceEstimate::Shares SurfaceEstimate::askRays(const Vec3f& position, const Vec3f& normal,
                                                 std::uint32_t pattern, float least,
                                                 TwoRadii& flux) const {
    const Frame frame(normal);
    const float height = apexHeight(m_scene, position, normal, m_radius);
    const std::uint64_t random = mixBits(pattern);
    const View view{position,
                    normal,
                    position + normal * height,
                    frame.tangent,
                    frame.bitangent,
                    toUnitFloat(static_cast<std::uint32_t>(random)),
                    toUnitFloat(static_cast<std::uint32_t>(random >> 32))};
    bool isPlane;
    if (isWhole(view, isPlane) && (isPlane || !m_scene.hasSheets())) {
        if (m_scene.hasSheets() && !m_weights) flux = m_map.fluxInPlane(position, normal, m_radius);
        return {};
    }
    const Shares share = shares(view);
    if (share.wide < least || !(share.wide > 0.0f)) return share;
    flux = fluxSeen(view);
    return share;
}

}  // namespace pm
