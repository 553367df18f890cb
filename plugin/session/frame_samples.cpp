// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "plugin/session/frame_samples.h"

#include <algorithm>
#include <array>
#include <optional>

#include "scheduler/buckets/bucket_grid.h"

namespace pm::plugin {

namespace {

// A sample in every four passes, as at levels 0 and 1, is one for each half in so many. A group has
// them in the first two passes, and a pixel that it was divided into in the next two: the first
// groups are divided after two passes.
constexpr std::uint32_t kPassesOfBothHalves = 8;

SampleRun samplesFromGroups(const FrameStore::NextSamples& next, std::uint32_t pass) {
    const std::uint32_t turn = pass % kPassesOfBothHalves / 2;
    const std::uint32_t count = turn == (next.isOfGroup ? 0 : 1) ? 1 : 0;
    if (next.isOfGroup) return {pass / kPassesOfBothHalves, count, count, true};
    return {next.had, std::max(next.count, count), count};
}

}  // namespace

FrameStore makeFrame(const RenderSettings& settings, bool sharesNoise,
                     const ErrorScale& errorScale) {
    const ChannelLayout layout = channelLayout(settings);
    std::optional<SampleRule> rule;
    if (settings.isAdaptive())
        rule =
            sampleRule(settings.aaLevel, settings.aaLevelMost, settings.aaThreshold, sharesNoise);
    return {settings.window, layout.count, layout.beauty, layout.biasProbe,
            layout.emission, rule,         errorScale};
}

std::uint64_t frameMemoryBytes(const RenderSettings& settings) {
    const ChannelLayout layout = channelLayout(settings);
    return FrameStore::memoryBytes(settings.window, layout.count, layout.biasProbe,
                                   settings.isAdaptive(),
                                   settings.isAdaptive() && settings.hasGroups());
}

void findSamples(const RenderSettings& settings, const FrameStore& frame, std::uint32_t pass,
                 const Rect& rect, std::span<SampleRun> runs) {
    std::array<FrameStore::NextSamples, kAtomSizePixels> next;
    auto run = runs.begin();
    for (std::int32_t y = rect.y0; y < rect.y1; ++y)
        for (std::int32_t x0 = rect.x0; x0 < rect.x1; x0 += kAtomSizePixels) {
            const Rect row{x0, y, std::min(x0 + kAtomSizePixels, rect.x1), y + 1};
            if (settings.isAdaptive()) frame.nextSamples(pass, row, next);
            for (std::int32_t x = row.x0; x < row.x1; ++x, ++run) {
                *run = fixedSamples(settings, x, y, pass);
                if (!settings.isAdaptive()) continue;
                const FrameStore::NextSamples& allotted =
                    next[static_cast<std::size_t>(x - row.x0)];
                *run =
                    settings.hasGroups()
                        ? samplesFromGroups(allotted, pass)
                        : SampleRun{allotted.had, std::max(allotted.count, run->count), run->seen};
            }
        }
}

}  // namespace pm::plugin
