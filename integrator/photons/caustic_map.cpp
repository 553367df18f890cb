// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/photons/caustic_map.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "integrator/photons/surface_estimate.h"
#include "integrator/sampling/warps.h"

namespace pm {

namespace {

// Fewer than this of the pilot say too little about the density.
constexpr std::uint32_t kFewestPilotPhotons = 4;
// Where the pilot has less than 1/16 of its typical density the estimate grows no wider: what is
// thinner than that is too dim to matter, and too wide a disc reaches round corners.
constexpr float kLargestRadius = 4.0f;
constexpr float kSmallestRadius = 1e-3f;

}  // namespace

PilotRadius::PilotRadius(std::span<const Photon> pilot, std::uint32_t estimatePhotons,
                         float fallback, const CancelCheck& cancel)
    : m_pilot(pilot, cancel),
      m_count(std::max(kFewestPilotPhotons, estimatePhotons / kPilotShare)),
      m_typical(m_pilot.size() > m_count ? m_pilot.typicalRadius(m_count) : fallback) {}

float PilotRadius::at(const Vec3f& position, const Vec3f& normal, NearestPhotons& scratch) const {
    const float largest = kLargestRadius * m_typical;
    const float radius = m_pilot.radiusOf({position, normal, m_count, largest}, scratch);
    // Photons in one point leave no area to divide by.
    return std::clamp(radius, kSmallestRadius * m_typical, largest);
}

TwoRadii CausticMap::irradiance(const Vec3f& position, const Vec3f& normal,
                                NearestPhotons& scratch) const {
    const float radius = m_radius.at(position, normal, scratch) * m_radiusFactor;
    TwoRadii flux = m_map.fluxWithin(position, normal, radius, scratch);
    SurfacePatch::Shares share;
    // In the dark there is nothing to correct.
    if (m_patches && !isBlack(flux.wide)) {
        const Scene& scene = m_patches->scene();
        SurfacePatch spare;
        const SurfacePatch& patch = m_patches->at(position, normal, radius, spare);
        if (!patch.speaksFor(scene, position, normal, radius)) {
            // Any pattern that depends on the place alone.
            const auto pattern =
                std::bit_cast<std::uint32_t>(position.x) ^ std::bit_cast<std::uint32_t>(position.y);
            return SurfaceEstimate(scene, m_map, radius).at(position, normal, pattern);
        }
        share = patch.shares(position, radius);
        if (patch.hidesSurface())
            flux = m_map.fluxWithin(position, normal, radius, [&](std::uint32_t index) {
                return patch.counts(scene, m_map.photon(index));
            });
    }
    const float discArea = kPi * radius * radius;
    return {flux.wide / (discArea * share.wide), flux.narrow / (0.5f * discArea * share.narrow)};
}

}  // namespace pm
