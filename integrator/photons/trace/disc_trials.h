// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "integrator/photons/map/photon_map.h"
#include "integrator/values/cancel_check.h"

namespace pm {

// What a pilot of photons in two independent halves, one of them marked, tells of how wide density
// estimates should be: discs of an area, of half of it, of a quarter, ... compete. Where light is
// even, the widest has the least noise; where it lies in filaments, as many photons of one half are
// found around those of the other however small a disc is taken, and wide ones only blur them.
class DiscTrials {
  public:
    static constexpr std::size_t kDiscs = 5;

    struct Request {
        std::uint32_t count = 0;  // of the pilot's photons on the widest disc, where there are
        // About each photon of the pilot, the radius that holds so many, scene units; infinite
        // where `largest` holds fewer.
        std::span<const float> radii;
        float largest = 0;
        // Of the variance of the pilot's own estimates, what is left in a picture, over what is
        // left of their squared bias.
        double noiseShare = 0;
    };
    // pilot, radii: must outlive this. Throws Error(kCancelled) soon after cancel is set.
    DiscTrials(const PhotonMap& pilot, const Request& request, const CancelCheck& cancel = {});

    // Of each photon, the best disc's radius over the widest one's, in (0, 1].
    const std::vector<float>& shares() const { return m_shares; }

  private:
    // Sums over photons, each as much as its flux.
    struct Sums {
        // Of the other half's flux around a photon, on discs of twice the widest one's area, of as
        // much, half, a quarter, ...: density over that of the photon's own half on the widest.
        std::array<double, kDiscs + 1> density{};
        double noise = 0;   // the relative variance of what both halves find on the widest
        double weight = 0;  // flux

        Sums& operator+=(const Sums& other);
        Sums& operator-=(const Sums& other);
        Sums& operator*=(double factor);
    };
    struct Trial;

    Sums tryOn(std::uint32_t leaf, Trial& trial) const;
    void addPhoton(std::uint32_t index, Trial& trial, Sums& sums) const;
    void choose(std::uint32_t first, std::uint32_t count, const Sums& expected);
    float bestOf(const Sums& sums) const;

    const PhotonMap& m_pilot;
    Request m_request;
    double m_meanFlux = 0;
    std::vector<Sums> m_before;  // of all leaves before one
    std::vector<float> m_shares;
};

}  // namespace pm
