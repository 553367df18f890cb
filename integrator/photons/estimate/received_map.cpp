// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/photons/estimate/received_map.h"

#include <algorithm>
#include <utility>

#include "integrator/photons/estimate/surface_estimate.h"

namespace pm {

namespace {

// Numbers are kept where others have their flux, as two that a float holds exactly.
constexpr std::uint32_t kNumbers = 1 << 20;

Rgb numbered(std::size_t number) {
    return {static_cast<float>(number % kNumbers), static_cast<float>(number / kNumbers), 0.0f};
}
std::size_t numberOf(const Rgb& flux) {
    return static_cast<std::size_t>(flux.r) + static_cast<std::size_t>(flux.g) * kNumbers;
}

std::vector<Photon> places(std::span<const ReceivedPhoton> received) {
    std::vector<Photon> photons(received.size());
    for (std::size_t i = 0; i < received.size(); ++i) {
        photons[i] = received[i].photon;
        photons[i].flux = numbered(i);
    }
    return photons;
}

// As CausticMap has them.
constexpr float kWidestDot = 1.5f, kDotSlope = 3.0f;

}  // namespace

ReceivedMap::ReceivedMap(const Scene& scene, std::vector<ReceivedPhoton> photons,
                         const PilotRadius& radius, float radiusFactor, const CancelCheck& cancel)
    : m_scene(scene),
      m_photons(std::move(photons)),
      m_map(places(m_photons), cancel, scene.coreRadiusIfAny()),
      m_radius(radius),
      m_radiusFactor(radiusFactor) {}

class ReceivedMap::Weights final : public PhotonWeights {
  public:
    Weights(const ReceivedMap& map, const Place& place, const Value& value, NearestPhotons& nearby)
        : PhotonWeights(nearby), m_map(map), m_place(place), m_value(value) {}
    Rgb of(std::uint32_t index) const override {
        const ReceivedPhoton& received = m_map.m_photons[numberOf(m_map.m_map.photon(index).flux)];
        if (m_place.unmetOnly && !received.photon.normal.isMarked()) return {};
        return received.photon.flux * m_value(received.from.unpack());
    }

  private:
    const ReceivedMap& m_map;
    const Place& m_place;
    const Value& m_value;
};

TwoRadii ReceivedMap::radiance(const Place& place, const Value& value,
                               NearestPhotons& scratch) const {
    if (m_map.empty()) return {};
    const float wanted = m_radius.at(place.position, place.normal, scratch);
    const float radius =
        std::max(wanted, kWidestDot * place.pixelWidth - kDotSlope * wanted) * m_radiusFactor;
    const Weights weights(*this, place, value, scratch);
    return SurfaceEstimate(m_scene, m_map, radius, weights)
        .at(place.position, place.normal, patternAt(place.position, radius));
}

}  // namespace pm
