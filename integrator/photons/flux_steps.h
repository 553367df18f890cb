// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstddef>
#include <cstdint>

#include "integrator/photons/photon_map.h"

namespace pm {

// Draws `count` of a map's photons in proportion to their flux, summed over the channels, in the
// order of the map, in which neighbours are near each other: one at each equal step of the flux
// (systematic sampling). u: in [0, 1), where in the steps; bright photons may be drawn more than
// once. Calls use(photon, share), share its flux over that of all. Returns the flux of all, W.
template <typename Use>
double visitBySteps(const PhotonMap& photons, std::size_t count, float u, const Use& use) {
    const auto size = static_cast<std::uint32_t>(photons.size());
    double whole = 0;
    for (std::uint32_t i = 0; i < size; ++i) whole += channelSum(photons.photon(i).flux);
    if (!(whole > 0)) return 0;
    const double step = whole / static_cast<double>(count);
    double upTo = 0;
    std::size_t drawn = 0;
    for (std::uint32_t i = 0; i < size && drawn < count; ++i) {
        const Photon photon = photons.photon(i);
        const double own = channelSum(photon.flux);
        upTo += own;
        for (; drawn < count && (static_cast<double>(drawn) + u) * step < upTo; ++drawn)
            use(photon, own / whole);
    }
    return whole;
}

}  // namespace pm
