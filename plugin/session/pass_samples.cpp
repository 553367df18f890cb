// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "plugin/session/pass_samples.h"

#include <array>

#include "plugin/session/frame_samples.h"
#include "scheduler/buckets/bucket_grid.h"

namespace pm::plugin {

namespace {

// One atom in four of a row, and one row in four, so that it costs next to nothing.
constexpr std::int32_t kStep = 4 * kAtomSizePixels;

double samplesOf(const RenderSettings& settings, const FrameStore& frame, std::uint32_t pass) {
    const Rect window = wholeAtoms(settings.window);
    std::array<SampleRun, kAtomPixels> runs;
    double samples = 0;
    for (std::int32_t y = window.y0; y < window.y1; y += kStep)
        for (std::int32_t x = window.x0; x < window.x1; x += kStep) {
            findSamples(settings, frame, pass, {x, y, x + kAtomSizePixels, y + kAtomSizePixels},
                        runs);
            for (const SampleRun& run : runs) samples += static_cast<double>(run.weight());
        }
    return samples;
}

}  // namespace

double samplesOverPassBefore(const RenderSettings& settings, const FrameStore& frame,
                             std::uint32_t pass) {
    if (!settings.isAdaptive() || pass == 0) return 1.0;
    const double before = samplesOf(settings, frame, pass - 1);
    return before > 0 ? samplesOf(settings, frame, pass) / before : 1.0;
}

}  // namespace pm::plugin
