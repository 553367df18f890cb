// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "integrator/scene/scene.h"
#include "integrator/transport/frame_renderer.h"

namespace pm::bench {

// A picture so far: the mean over the passes rendered, and of the even and the odd ones alone,
// whose errors share no noise.
struct Accumulated {
    std::uint32_t passes = 0;
    double wallSeconds = 0, processorSeconds = 0;
    double renderSeconds = 0;                     // of it, without photons and maps
    std::vector<double> mean, evenMean, oddMean;  // RGB, row by row
};

// Renders all passes of `settings` on `threads` threads, the bucket order plain rows of 32 x 32,
// and calls `after` with the picture after passes 1, 2, 4, 8, ...; its time does not count. Returns
// the counters. Threads: uses a TBB arena of its own.
RenderCounters renderPasses(const std::shared_ptr<const Scene>& scene,
                            const RenderSettings& settings, int threads,
                            const std::function<void(const Accumulated&)>& after);

}  // namespace pm::bench
