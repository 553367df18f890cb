// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "integrator/photons/estimate/caustic_map.h"
#include "integrator/photons/map/photon_map.h"
#include "integrator/scene/scene.h"

namespace pm {

// Caustics of one pass where glossy and broad lobes receive them: radiance is a sum over photons of
// what the lobe makes of each, by where it came from. Source: Jensen 2001, section 7.4.
// Threads: const functions from any, at once.
class ReceivedMap {
  public:
    // While it is built, and once it is; directions and fluxes included.
    static constexpr std::uint64_t kBytesPerPhoton =
        PhotonMap::kBytesPerPhoton + sizeof(ReceivedPhoton);
    static constexpr std::uint64_t kHeldBytesPerPhoton =
        PhotonMap::kHeldBytesPerPhoton + sizeof(ReceivedPhoton);

    // scene and radius must outlive this. radiusFactor: this pass's radii over the first pass's.
    // Throws Error(kCancelled) soon after cancel is set.
    ReceivedMap(const Scene& scene, std::vector<ReceivedPhoton> photons, const PilotRadius& radius,
                float radiusFactor, const CancelCheck& cancel = {});

    struct Place {
        Vec3f position, normal;  // the normal on the side where the photons came in
        bool unmetOnly;          // only photons that no path finds count: those that are marked
        float pixelWidth;        // as CausticMap has it
    };
    // Of light that arrives from a unit vector, what leaves along the way looked from, sr^-1: the
    // value of the lobe without its cosine.
    using Value = std::function<Rgb(const Vec3f& from)>;
    // W m^-2 sr^-1.
    TwoRadii radiance(const Place& place, const Value& value, NearestPhotons& scratch) const;

    bool empty() const { return m_map.empty(); }
    std::size_t size() const { return m_photons.size(); }
    std::uint64_t memoryBytes() const {
        return m_map.memoryBytes() + m_photons.size() * sizeof(ReceivedPhoton);
    }

  private:
    class Weights;

    const Scene& m_scene;
    std::vector<ReceivedPhoton> m_photons;
    PhotonMap m_map;  // has a photon's number in place of its flux
    const PilotRadius& m_radius;
    float m_radiusFactor;
};

}  // namespace pm
