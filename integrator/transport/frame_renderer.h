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

#include "integrator/transport/frame/channel_layout.h"
#include "integrator/transport/frame/map_paging.h"
#include "integrator/transport/frame/render_counters.h"
#include "integrator/transport/frame/render_settings.h"
#include "integrator/transport/plan/plan.h"
#include "integrator/values/notice.h"
#include "integrator/values/rect.h"

namespace pm {

class PhotonSink;
class PhotonSource;
class Scene;

// The samples that a pixel gets in one pass: a run of its low-discrepancy sequence. Even passes
// have one sequence, odd passes another.
struct SampleRun {
    std::uint32_t first = 0, count = 0;
    std::uint32_t seen = 0;  // the first so many are told of in ChannelLayout::seen
    // They are those of its group of 2 x 2 pixels, which is sampled as one pixel of twice the side
    // is, by a sequence of its own. The group's other pixels have to have the same run.
    bool isOfGroup = false;

    // What the pixel counts as its own: of a group's samples a quarter.
    float weight() const { return static_cast<float>(count) * (isOfGroup ? 0.25f : 1.0f); }
};

// What a render of a fixed level gives a pixel in a pass. At levels 0 and 1, one sample of the
// group or pixel in every four passes, in turns an even and an odd one.
SampleRun fixedSamples(const RenderSettings& settings, std::int32_t x, std::int32_t y,
                       std::uint32_t pass);

// One frame of one scene: traces each pass's photons, then renders any rectangle of that pass.
// A picture is a function of scene, settings and plan only.
class FrameRenderer {
  public:
    // plan: makePlan()'s of this scene and these settings, or that with other numbers in it. Takes
    // no time to speak of: see prepare(). Throws Error when the settings and the scene don't fit
    // (no camera, ...).
    FrameRenderer(std::shared_ptr<const Scene> scene, const RenderSettings& settings, Plan plan);
    // By makePlan().
    FrameRenderer(std::shared_ptr<const Scene> scene, const RenderSettings& settings);
    ~FrameRenderer();

    // With the pilot's number of lamp samples once it is prepared.
    const Plan& plan() const;
    ChannelLayout layout() const;

    // What the first pass begins with where nobody did it before: the choice of lamps is built and
    // learns which of them reach where, and a pilot finds the plan's lamp samples. In parallel in
    // the calling TBB arena. Throws Error(kCancelled) soon after `cancelled` is set, and may be
    // asked again then.
    void prepare(const std::atomic<bool>& cancelled);

    // Before the first pass: from now on photons are read from `source` in place of being traced.
    // It must outlive this, and hold what tracePass() wrote of the same lights, surfaces and plan.
    void readPhotons(const PhotonSource& source);
    // Before the first pass: maps of global, caustic and refocused photons are kept in pages, for
    // the same picture. paging.pages must outlive this. Errors of its files come out of what
    // begins, adds and renders passes.
    void pageMaps(const MapPaging& paging);
    // Traces the photons of pass `pass` into the sink, before those of the first call the pilots'.
    // No map is built, no pixel can be rendered. The rest as beginPass.
    void tracePass(std::uint32_t pass, PhotonSink& sink, const std::atomic<bool>& cancelled,
                   const std::function<void(double)>& progress);

    // Traces the photons of pass `pass` and builds its maps, in parallel in the calling TBB arena;
    // the maps of the pass before are dropped. progress gets a fraction in [0,1], from any thread
    // but one call at a time; may be empty. Throws Error(kCancelled) soon after `cancelled` is set.
    void beginPass(std::uint32_t pass, const std::atomic<bool>& cancelled,
                   const std::function<void(double)>& progress);

    // The same, but the maps of the passes that were begun or added before stay as well, so that
    // their pixels may be rendered in any order. Not while anything is rendered.
    void addPass(std::uint32_t pass, const std::atomic<bool>& cancelled,
                 const std::function<void(double)>& progress);

    // Renders the pixels of `region` for a pass that was begun or added and whose maps were not
    // dropped; without a number for the one that came last. runs: the samples of each pixel,
    // row by row, may be none; those of a pixel's later passes have to follow on. pixels:
    // layout().count floats a pixel: the mean over its samples of this pass, 0 where it has none.
    // A group is rendered once, by its pixels in the region.
    // Threads: any, at once. Returns early, with the rest 0, soon after `cancelled` is set.
    void renderRegion(std::uint32_t pass, const Rect& region, std::span<const SampleRun> runs,
                      std::span<float> pixels, const std::atomic<bool>& cancelled) const;
    void renderRegion(const Rect& region, std::span<const SampleRun> runs, std::span<float> pixels,
                      const std::atomic<bool>& cancelled) const;
    // The same with fixedSamples(); weights: of each pixel's run.
    void renderRegion(const Rect& region, std::span<float> pixels, std::span<float> weights,
                      const std::atomic<bool>& cancelled) const;

    // Nothing of `region` will be rendered any more in any of the passes: what was kept for its
    // pixels alone is given back. Regions divide `all`, outside of which nothing is rendered.
    // Threads: any, at once, beside those that render other regions.
    void forget(const Rect& region, const Rect& all) const;

    // Threads: any time.
    RenderCounters counters() const;
    // Notices that came up since the last call (no photons, bad values, ...).
    std::vector<Notice> takeNotices();

  private:
    struct Impl;
    std::unique_ptr<Impl> m_impl;
};

}  // namespace pm
