// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstddef>
#include <vector>

#include "integrator/photons/map/photon_map.h"
#include "integrator/values/cancel_check.h"

namespace pm {

// Photons of a map, drawn in proportion to their flux, summed over the channels.
struct DrawnByFlux {
    struct Drawn {
        Photon photon;
        double share;  // of the flux of all
    };
    std::vector<Drawn> photons;  // none where there is no flux
    double flux = 0;             // of all photons of the map, W
};

// Draws `count`, in the order of the map, in which neighbours are near each other: one at each
// equal step of the flux (systematic sampling). u: in [0, 1), where in the steps; bright photons
// may be drawn more than once. Parallel in the calling TBB arena, the same bits for any number of
// threads. Throws Error(kCancelled) soon after cancel is set.
DrawnByFlux drawBySteps(const PhotonMap& photons, std::size_t count, float u,
                        const CancelCheck& cancel = {});

}  // namespace pm
