// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "integrator/photons/estimate/surface_patches.h"
#include "integrator/photons/map/photon_map.h"

namespace pm {

// How wide estimates are: found once a render from a small pilot of photons that enter no estimate,
// since a radius that depended on the photons it counts would bias what it counts.
// Threads: const functions from any, at once.
class PilotRadius {
  public:
    static constexpr std::uint32_t kPilotShare = 4;
    static constexpr std::uint64_t kHeldBytesPerPhoton =
        PhotonMap::kHeldBytesPerPhoton + sizeof(float);
    // Two places' radii differ by no more than this times their distance. With 1, as k-nearest
    // radii do, all discs beside a bright patch reach into it: in the dark it is blurred over
    // 1/d^2.
    static constexpr float kSlope = 0.25f;

    // pilot: photons as the map's, 1/kPilotShare as many of them emitted, so that a radius with
    // estimatePhotons / kPilotShare of the pilot's holds about estimatePhotons of the map's.
    // fallback: the typical radius where the pilot found too little; scene units, > 0. Throws
    // Error(kCancelled) soon after cancel is set.
    PilotRadius(std::span<const Photon> pilot, std::uint32_t estimatePhotons, float fallback,
                const CancelCheck& cancel = {})
        : PilotRadius(PhotonMap(pilot, cancel), estimatePhotons, fallback, cancel) {}
    PilotRadius(PhotonMap pilot, std::uint32_t estimatePhotons, float fallback,
                const CancelCheck& cancel = {});

    // One for all places: what half of the pilot's photons need; scene units, > 0.
    float typical() const { return m_typical; }
    // That alone, of a pilot's map.
    static float typicalOf(const PhotonMap& pilot, std::uint32_t estimatePhotons, float fallback);

    // From place to place: narrow where light is focused, wide where it is thin; scene units, > 0.
    // The least of what the place itself needs and of what each photon that it needs for that needs
    // itself, plus kSlope times the way there.
    float at(const Vec3f& position, const Vec3f& normal, NearestPhotons& scratch) const;

    const PhotonMap& photons() const { return m_pilot; }
    std::uint64_t memoryBytes() const {
        return m_pilot.memoryBytes() + m_ofPhotons.size() * sizeof(float);
    }

  private:
    PhotonMap m_pilot;
    std::uint32_t m_count;
    float m_typical;
    std::vector<float> m_ofPhotons;  // what each needs itself; may be infinite
};

// Caustics of one pass, estimated straight at the surfaces that the camera sees.
// Threads: const functions from any, at once.
class CausticMap {
  public:
    // radiusFactor: this pass's radii over the first pass's. radius and patches must outlive this.
    // patches: null where all discs are to be taken as whole. Throws Error(kCancelled) soon after
    // cancel is set.
    CausticMap(std::span<const Photon> photons, const PilotRadius& radius, float radiusFactor,
               const SurfacePatches* patches = nullptr, const CancelCheck& cancel = {})
        : CausticMap(PhotonMap(photons, cancel), radius, radiusFactor, patches) {}
    CausticMap(PhotonMap map, const PilotRadius& radius, float radiusFactor,
               const SurfacePatches* patches = nullptr)
        : m_map(std::move(map)),
          m_radius(radius),
          m_radiusFactor(radiusFactor),
          m_patches(patches) {}

    // Irradiance, W m^-2, on the side of the normal, at the radius that belongs there. Where the
    // disc is not all surface the flux is divided by the area that is, and only photons seen from
    // above it count. pixelWidth: on the surface, scene units. Of light that falls within less than
    // a pixel few of the pixel's samples would tell: in the first pass radii are 3/8 of it or more.
    TwoRadii irradiance(const Vec3f& position, const Vec3f& normal, NearestPhotons& scratch,
                        float pixelWidth = 0.0f) const;

    const PhotonMap& photons() const { return m_map; }
    std::uint64_t memoryBytes() const { return m_map.memoryBytes(); }

  private:
    PhotonMap m_map;
    const PilotRadius& m_radius;
    float m_radiusFactor;
    const SurfacePatches* m_patches;
};

}  // namespace pm
