// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/photons/caustic_map.h"

#include <algorithm>
#include <cmath>

#include "integrator/sampling/warps.h"

namespace pm {

namespace {

// Fewer than this of the pilot say too little about the density.
constexpr std::uint32_t kFewestPilotPhotons = 4;
// Where the pilot has less than 1/64 of its typical density the estimate grows no wider: what is
// thinner than that is too dim to matter, and too wide a disc reaches round corners.
constexpr float kLargestRadius = 8.0f;

}  // namespace

CausticRadius::CausticRadius(std::vector<Photon> pilot, std::uint32_t estimatePhotons)
    : m_pilot(std::move(pilot)),
      m_count(std::max(kFewestPilotPhotons, estimatePhotons / kPilotShare)),
      m_largest(kLargestRadius * m_pilot.typicalRadius(m_count)) {}

float CausticRadius::at(const Vec3f& position, const Vec3f& normal, NearestPhotons& scratch) const {
    m_pilot.findNearest({position, normal, m_count, m_largest}, scratch);
    if (scratch.found().size() < m_count) return m_largest;
    // A thousandth of what is typical of the scene: photons in one point leave no area to divide
    // by.
    const float smallest = 1e-4f * m_largest;
    return std::max(smallest, std::sqrt(scratch.found().front().distanceSquared));
}

Rgb CausticMap::irradiance(const Vec3f& position, const Vec3f& normal,
                           NearestPhotons& scratch) const {
    const float radius = m_radius.at(position, normal, scratch) * m_radiusFactor;
    return m_map.fluxWithin(position, normal, radius) / (kPi * radius * radius);
}

}  // namespace pm
