// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "integrator/transport/plan.h"
#include "integrator/transport/render_settings.h"
#include "integrator/values/notice.h"
#include "integrator/values/rect.h"

namespace pm {

class Scene;

// Where each layer stands in a pixel's floats. A layer that is not wanted has offset -1.
struct ChannelLayout {
    std::int32_t beauty = 0;     // 3: radiance, the sum of the four parts below
    std::int32_t alpha = 3;      // 1: coverage
    std::int32_t direct = 4;     // 3
    std::int32_t indirect = 7;   // 3
    std::int32_t caustic = 10;   // 3
    std::int32_t emission = 13;  // 3
    std::int32_t albedo = -1;    // 3: premultiplied by coverage
    std::int32_t normal = -1;    // 3: world, premultiplied by coverage
    std::int32_t depth = -1;     // 1: along the view axis, scene units, premultiplied by coverage
    // 3: beauty with the radii of all estimates narrowed by sqrt(2), minus beauty; what shows bias
    std::int32_t biasProbe = -1;
    std::int32_t count = 16;  // floats a pixel
};

ChannelLayout channelLayout(const RenderSettings& settings);

// What happened while rendering; summed over all passes, independent of thread timing.
struct RenderCounters {
    std::uint64_t cameraSamples = 0;
    std::uint64_t rays = 0;        // of any kind, photons' included
    std::uint64_t badSamples = 0;  // NaN or infinite, replaced by 0
    std::uint64_t photonsEmitted = 0;
    std::uint64_t photonsStoredGlobal = 0;
    std::uint64_t photonsStoredCaustic = 0;
    std::uint64_t photonsLost = 0;  // ended for a numerical reason
    // Flux over all passes and channels, W: emitted = absorbed + escaped + lost.
    double fluxEmitted = 0, fluxAbsorbed = 0, fluxEscaped = 0, fluxLost = 0;
    double photonSeconds = 0, mapSeconds = 0;
    std::uint64_t peakMapBytes = 0;
};

// One frame of one scene: traces each pass's photons, then renders any rectangle of that pass.
// A picture is a function of scene and settings only.
class FrameRenderer {
  public:
    // Throws Error when the settings and the scene don't fit (no camera, ...).
    FrameRenderer(std::shared_ptr<const Scene> scene, const RenderSettings& settings);
    ~FrameRenderer();

    const Plan& plan() const;
    ChannelLayout layout() const;

    // Traces the photons of pass `pass` and builds its maps, in parallel in the calling TBB arena;
    // the maps of the pass before are dropped. progress gets a fraction in [0,1], from any thread
    // but one call at a time; may be empty. Throws Error(kCancelled) soon after `cancelled` is set.
    void beginPass(std::uint32_t pass, const std::atomic<bool>& cancelled,
                   const std::function<void(double)>& progress);

    // Renders the pixels of `region` for the pass that was begun. pixels: layout().count floats a
    // pixel, row by row: the mean over the pixel's samples of this pass; weights: one a pixel, its
    // number of samples in this pass (may be 0). Threads: any, at once. Returns early, with the
    // rest 0, soon after `cancelled` is set.
    void renderRegion(const Rect& region, std::span<float> pixels, std::span<float> weights,
                      const std::atomic<bool>& cancelled) const;

    // Threads: any time.
    RenderCounters counters() const;
    // Notices that came up since the last call (no photons, bad values, ...).
    std::vector<Notice> takeNotices();

  private:
    struct Impl;
    std::unique_ptr<Impl> m_impl;
};

}  // namespace pm
