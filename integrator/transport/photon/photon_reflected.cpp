// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// PhotonPath: the light that a surface reflects, of lamps and of maps.
#include <algorithm>
#include <cmath>
#include <optional>

#include "integrator/transport/photon/photon_path.h"

namespace pm {

namespace {

// Lamps that fill less than this share of the cosine-weighted view are found by next-event
// estimation alone: the other strategy's weight is below its square there.
constexpr float kLargeLampShare = 0.02f;
// Where there are no gather points a sample sends rays of its own: few, as it is one of many, and
// more where the points have many.
constexpr std::uint32_t kFewestOwnRays = 4, kRaysOfPointToAnOwnRay = 8;

// Where a place's share is below this, refocused light is estimated the more seldom.
constexpr float kLeastRefocused = 0.33f;

// To a part of what a camera sample finds.
void add(const TwoRadii& irradiance, const Rgb& reflected, Rgb& part, SampleRadiance& result) {
    part += reflected * irradiance.wide;
    result.biasProbe += reflected * (irradiance.narrow - irradiance.wide);
}

}  // namespace

// All light that a surface reflects by lobes that are not delta, but for what a ray along the
// diffuse one has to find.
PhotonPath::StillToFind PhotonPath::addReflected(const Surface& surface, const Bsdf& bsdf,
                                                 const PhotonBranch& branch) {
    StillToFind still;
    if (bsdf.has(Lobe::kDiffuse)) still = readMaps(surface, bsdf, branch);
    still.width = branch.footprint.width();
    if (still.indirect && m_maps.lamps) sampleCaustics(surface, bsdf, branch, still.ownRays);
    if (bsdf.reflectsLamps()) {
        const DirectRadiance direct = estimateDirect(
            m_scene, m_lights, surface, bsdf, still.lamps, branch.state.hasMetNoDiffuse(),
            branch.lampSamples, branch.random, m_result.rays);
        addByLobes(direct, bsdf, branch.state, [&](const PathState& state, const Rgb& light) {
            if (!isOfMap(state)) m_result.of(state.classify()) += branch.carried * light;
        });
    }
    if (m_maps.received) addReceived(surface, bsdf, branch);
    return still;
}

// Caustics by the lobes around a direction, where the path has met no wide one before. Narrow ones
// follow the light of lamps that rays meet; of others they have what came by way of delta lobes
// alone.
void PhotonPath::addReceived(const Surface& surface, const Bsdf& bsdf, const PhotonBranch& branch) {
    if (branch.state.isPastWide) return;
    const Vec3f& ng = bsdf.facingGeometricNormal();
    const float pixelWidth = m_view.beam.widthAfter(branch.way);
    const Rgb& throughput = branch.carried;
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
            add(m_maps.received->radiance(place, value, m_scratch), throughput, m_result.caustic,
                m_result);
        }
    }
}

PhotonPath::StillToFind PhotonPath::readMaps(const Surface& surface, const Bsdf& bsdf,
                                             const PhotonBranch& branch) {
    SampleRadiance& result = m_result;
    const Rgb reflected = bsdf.reflectedOf(branch.carried);
    StillToFind still;
    GatherPoints::Estimate indirect;
    const Vec3f& normal = bsdf.facingGeometricNormal();
    // What is kept knows where light came from by the surface's admission alone.
    const std::optional<Admission> admission = bsdf.admission();
    const GatherPoints::Place place{
        m_view.screen,
        surface.position,
        bsdf.facingShadingNormal(),
        normal,
        surface.offset,
        admission ? GatherPoints::admitsOf(*admission, surface.material) : GatherPoints::kEven};
    const bool kept = m_maps.points && admission && m_maps.points->estimate(place, indirect);
    result.rays += indirect.rays;
    if (kept) {
        add(indirect.irradiance, reflected, result.indirect, result);
        if (indirect.lampShare < kLargeLampShare) still.lamps = DirectStrategy::kNextEventOnly;
    }
    if (m_maps.caustic) {
        const float pixelWidth = m_view.beam.widthAfter(branch.way);
        add(m_maps.caustic->irradiance(surface.position, normal, m_scratch, pixelWidth), reflected,
            result.caustic, result);
    }
    still.indirect = !kept && m_maps.global;
    if (!still.indirect) return still;
    const float share = branch.share * partOf(bsdf, Lobe::kDiffuse);
    still.ownRays = ownGatherRays(share);
    if (m_maps.refocused) addRefocused(place, indirect.clearance, share, reflected, branch);
    return still;
}

std::uint32_t PhotonPath::ownGatherRays(float share) const {
    const GatherPoints* points = m_maps.points;
    const std::uint32_t rays =
        points ? std::max(kFewestOwnRays, points->raysOfPoint() / kRaysOfPointToAnOwnRay)
               : kFewestOwnRays;
    return raysOfShare(rays, share);
}

// Where there is no gather point. Such an estimate costs as much as many rays: of what carries
// little few are made.
void PhotonPath::addRefocused(const GatherPoints::Place& place, float clearance, float share,
                              const Rgb& reflected, const PhotonBranch& branch) {
    const float probability = std::min(1.0f, share / kLeastRefocused);
    if (!(branch.random.get1D(Purpose::kRefocused) < probability)) return;
    const std::uint32_t pattern = patternAt(place.position, m_maps.refocused->radius());
    const TwoRadii irradiance =
        m_maps.points ? m_maps.points->refocusedAt(place, clearance, pattern)
                      : m_maps.refocused->at(place.position, place.geometricNormal, pattern);
    add(irradiance, reflected * (1.0f / probability), m_result.indirect, m_result);
}

// What a sample's own gather rays leave out of the light that caustics send straight to a surface.
void PhotonPath::sampleCaustics(const Surface& surface, const Bsdf& bsdf,
                                const PhotonBranch& branch, std::uint32_t rays) {
    const Vec3f& up = bsdf.facingGeometricNormal();
    const VirtualLamps::Place place{surface.position, surface.position + up * surface.offset,
                                    bsdf.facingShadingNormal(), up,
                                    bsdf.admission().value_or(Admission{})};
    m_result.rays += VirtualLamps::raysBeside(rays);
    m_result.indirect += bsdf.reflectedOf(branch.carried) *
                         m_maps.lamps->sampled(place, rays, branch.random.get1D(Purpose::kCaustic));
}

}  // namespace pm
