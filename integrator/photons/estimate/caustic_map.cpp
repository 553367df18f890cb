// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/photons/estimate/caustic_map.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "integrator/photons/estimate/surface_estimate.h"
#include "integrator/photons/trace/disc_trials.h"
#include "integrator/sampling/warps.h"

namespace pm {

namespace {

// Fewer than this of the pilot say too little about the density.
constexpr std::uint32_t kFewestPilotPhotons = 4;
// Where the pilot has less than 1/16 of its typical density the estimate grows no wider: what is
// thinner than that is too dim to matter, and too wide a disc reaches round corners.
constexpr float kLargestRadius = 4.0f;
constexpr float kSmallestRadius = 1e-3f;
// Of a pilot's variance 1/kPilotShare is left in a pass; of eight passes' mean so much, over what
// is left of the squared bias: radii shrink meanwhile, see radiusFactor.
constexpr double kNoiseShare = 0.12;
// The radius, in pixels' widths, of a disc for light that lies in one point: four samples of each
// pixel find it to 5 %. ...
constexpr float kWidestDot = 1.5f;
// ... It falls so steeply with the radius that the light asks for: none is below 3/8 of a pixel's
// width, and none that is above that is widened, which would only blur.
constexpr float kDotSlope = 3.0f;
// Photons whose radii are found at a time.
constexpr std::uint32_t kGrain = 512;

// Of a pilot.
std::uint32_t countOf(std::uint32_t estimatePhotons) {
    return std::max(kFewestPilotPhotons, estimatePhotons / PilotRadius::kPilotShare);
}

}  // namespace

PilotRadius::PilotRadius(PhotonMap pilot, std::uint32_t estimatePhotons, float fallback,
                         const CancelCheck& cancel)
    : m_pilot(std::move(pilot)),
      m_count(countOf(estimatePhotons)),
      m_typical(typicalOf(m_pilot, estimatePhotons, fallback)),
      m_ofPhotons(m_pilot.size()) {
    const auto size = static_cast<std::uint32_t>(m_pilot.size());
    tbb::parallel_for(tbb::blocked_range<std::uint32_t>(0, size, kGrain), [&](const auto& range) {
        cancel.throwIfSet("finding the radii of caustics");
        NearestPhotons scratch;
        for (std::uint32_t i = range.begin(); i < range.end(); ++i) {
            const Photon photon = m_pilot.photon(i);
            m_ofPhotons[i] = m_pilot.radiusOf(
                {photon.position, photon.normal.unpack(), m_count, kLargestRadius * m_typical, i},
                scratch);
        }
    });
    const float largest = kLargestRadius * m_typical;
    const DiscTrials trials(m_pilot, {m_count, m_ofPhotons, largest, kNoiseShare}, cancel);
    for (std::uint32_t i = 0; i < size; ++i)
        if (const float share = trials.shares()[i]; share < 1.0f)
            m_ofPhotons[i] = share * std::min(m_ofPhotons[i], largest);
}

float PilotRadius::typicalOf(const PhotonMap& pilot, std::uint32_t estimatePhotons,
                             float fallback) {
    const std::uint32_t count = countOf(estimatePhotons);
    return pilot.size() > count ? pilot.typicalRadius(count) : fallback;
}

float PilotRadius::at(const Vec3f& position, const Vec3f& normal, NearestPhotons& scratch) const {
    const float largest = kLargestRadius * m_typical;
    const float reach =
        std::min(m_pilot.radiusOf({position, normal, m_count, largest}, scratch), largest);
    float radius = reach;
    m_pilot.visitAccepted(
        position, normal, reach, scratch, [&](std::uint32_t index, float distanceSquared) {
            radius = std::min(radius, m_ofPhotons[index] + kSlope * std::sqrt(distanceSquared));
        });
    // Photons in one point leave no area to divide by.
    return std::clamp(radius, kSmallestRadius * m_typical, largest);
}

TwoRadii CausticMap::irradiance(const Vec3f& position, const Vec3f& normal, NearestPhotons& scratch,
                                float pixelWidth) const {
    const float wanted = m_radius.at(position, normal, scratch);
    const float radius =
        std::max(wanted, kWidestDot * pixelWidth - kDotSlope * wanted) * m_radiusFactor;
    TwoRadii flux = m_map.fluxWithin(position, normal, radius, scratch);
    SurfacePatch::Shares share;
    // In the dark there is nothing to correct.
    if (m_patches && !isBlack(flux.wide)) {
        const Scene& scene = m_patches->scene();
        SurfacePatch spare;
        const SurfacePatch& patch = m_patches->at(position, normal, radius, spare);
        if (!patch.speaksFor(scene, position, normal, radius)) {
            return SurfaceEstimate(scene, m_map, radius)
                .at(position, normal, patternAt(position, radius));
        }
        share = patch.shares(position, radius);
        flux = patch.countedFlux(scene, m_map, position, normal, radius, flux);
    }
    const float discArea = kPi * radius * radius;
    return {flux.wide / (discArea * share.wide), flux.narrow / (0.5f * discArea * share.narrow)};
}

}  // namespace pm
