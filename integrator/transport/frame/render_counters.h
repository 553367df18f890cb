// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>

#include "integrator/transport/frame/bad_samples.h"

namespace pm {

// What happened while rendering; summed over all passes, independent of thread timing.
struct RenderCounters {
    std::uint64_t cameraSamples = 0;
    std::uint64_t rays = 0;  // of any kind, photons' included
    BadSamples badSamples;   // replaced by 0
    std::uint64_t photonsEmitted = 0;
    std::uint64_t photonsStoredGlobal = 0;
    std::uint64_t photonsStoredCaustic = 0;
    std::uint64_t photonsLost = 0;  // ended for a numerical reason, or the number of their events
    // Camera paths that ended for the number of their events (EventCount), and what light found
    // from there on would have counted for, in all.
    std::uint64_t pathsCut = 0;
    double throughputCut = 0;
    // Gather rays of each gather point, all passes alike; 0 before the first or without points.
    std::uint32_t gatherRaysOfPoint = 0;
    bool photonsInFocus = false;    // global ones aimed at where gather rays end
    bool gatherRaysGuided = false;  // towards where photons say that light comes from
    std::uint32_t lampSamples = 0;  // of a camera sample; 0 before the first pass
    // Flux over all passes and channels, W: emitted = absorbed + escaped + lost.
    double fluxEmitted = 0, fluxAbsorbed = 0, fluxEscaped = 0, fluxLost = 0;
    // The same of the caustic photons.
    double causticFluxEmitted = 0, causticFluxLost = 0;
    double photonSeconds = 0, mapSeconds = 0;
    std::uint64_t peakMapBytes = 0;

    // Of the light, the share that may be missing since photons and paths were cut.
    double shareCut() const;
};

}  // namespace pm
