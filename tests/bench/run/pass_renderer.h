// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Renders a frame pass by pass in this process, adaptive samples included, without the C interface.
#pragma once

#include <tbb/task_arena.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "integrator/scene/scene.h"
#include "integrator/transport/frame_renderer.h"
#include "scheduler/film/frame_store.h"

namespace pm::bench {

// One pass of a whole frame: the floats of ChannelLayout, and the samples of each pixel.
struct Pass {
    std::vector<float> pixels, weights;

    explicit Pass(const RenderSettings& settings);
};

// Three of a frame's channels, those from `first` on, row by row.
std::vector<double> channelsOf(const FrameStore& store, std::int32_t first);

// Threads: one at a time; works in a TBB arena of its own.
class PassRenderer {
  public:
    // Changes the samples of a pixel, row by row of the frame, in a pass from what the settings
    // say. Called at once for several pixels.
    using Chooser = std::function<void(std::uint32_t pass, std::size_t pixel, SampleRun& run)>;

    // The sides of the settings' window are multiples of 8 pixels. threads: of the render. choose:
    // empty: as the settings say.
    PassRenderer(std::shared_ptr<const Scene> scene, const RenderSettings& settings,
                 const Plan& plan, int threads, Chooser choose = {});

    // Renders the next pass and adds it to the frame. Returns it, until the next call.
    const Pass& next();
    const FrameStore& frame() const { return m_frame; }
    std::vector<double> beauty() const;

  private:
    void renderStrips();

    RenderSettings m_settings;
    Chooser m_choose;
    tbb::task_arena m_arena;
    std::unique_ptr<FrameRenderer> m_renderer;
    FrameStore m_frame;
    Pass m_pass;
    std::uint32_t m_passes = 0;  // done
};

}  // namespace pm::bench
