// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <atomic>
#include <cstdint>

#include "integrator/transport/frame/render_settings.h"

namespace pm {

class Scene;
struct Plan;

// How often photons land, by a few that are traced before anything is planned.
struct LandingPilot {
    // Of what is emitted, how often it lands: where all reflect r, 1 / (1 - r) times.
    double landings = 0;
    double storedInChains = 0;  // landings of a photon that LongChains would store

    // In parallel in the calling TBB arena; at most a fraction of a second. Finds nothing where no
    // lamp shines. Throws Error(kCancelled) soon after `cancelled` is set.
    static LandingPilot of(const Scene& scene, const RenderSettings& settings,
                           const std::atomic<bool>& cancelled);
};

// Expects of the plan's photons what as many as a pilot has do; of caustic ones those count that
// meet what they are aimed at. Throws Error(kCancelled) soon after `cancelled` is set.
void expectLandings(const Scene& scene, const RenderSettings& settings,
                    const std::atomic<bool>& cancelled, Plan& plan);

}  // namespace pm
