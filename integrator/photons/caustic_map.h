// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "integrator/photons/photon_map.h"

namespace pm {

// How wide caustic estimates are, from point to point: narrow where light is focused, wide where it
// is thin. Found once a render, from a small pilot of photons that enter no estimate: a radius that
// depended on the photons it counts would bias what it counts.
// Threads: const functions from any, at once.
class CausticRadius {
  public:
    // pilot: photons as the map's, 1/kPilotShare as many of them emitted, so that a radius with
    // estimatePhotons / kPilotShare of the pilot's holds about estimatePhotons of the map's.
    CausticRadius(std::vector<Photon> pilot, std::uint32_t estimatePhotons);

    static constexpr std::uint32_t kPilotShare = 8;

    // Radius for the first pass, scene units, > 0.
    float at(const Vec3f& position, const Vec3f& normal, NearestPhotons& scratch) const;

    std::uint64_t memoryBytes() const { return m_pilot.memoryBytes(); }

  private:
    PhotonMap m_pilot;
    std::uint32_t m_count;
    float m_largest;  // scene units
};

// Caustics of one pass, estimated straight at the surfaces that the camera sees.
// Threads: const functions from any, at once.
class CausticMap {
  public:
    // radiusFactor: this pass's radii over the first pass's. radius must outlive this.
    CausticMap(std::vector<Photon> photons, const CausticRadius& radius, float radiusFactor)
        : m_map(std::move(photons)), m_radius(radius), m_radiusFactor(radiusFactor) {}

    // Irradiance, W m^-2, on the side of the normal.
    Rgb irradiance(const Vec3f& position, const Vec3f& normal, NearestPhotons& scratch) const;

    std::uint64_t memoryBytes() const { return m_map.memoryBytes(); }

  private:
    PhotonMap m_map;
    const CausticRadius& m_radius;
    float m_radiusFactor;
};

}  // namespace pm
