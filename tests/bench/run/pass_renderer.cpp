// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "tests/bench/run/pass_renderer.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cstddef>

#include "plugin/session/frame_samples.h"

namespace pm::bench {

namespace {

constexpr std::int32_t kRows = 8;  // of a strip
const std::atomic<bool> kNotCancelled{false};

}  // namespace

Pass::Pass(const RenderSettings& settings)
    : pixels(static_cast<std::size_t>(settings.window.area()) *
             static_cast<std::size_t>(channelLayout(settings).count)),
      weights(static_cast<std::size_t>(settings.window.area())) {}

std::vector<double> channelsOf(const FrameStore& store, std::int32_t first) {
    const Rect& window = store.window();
    std::vector<float> rgb(3 * static_cast<std::size_t>(window.area()));
    constexpr std::int64_t kPixelBytes = 3 * sizeof(float);
    store.read(window, first, 3, rgb.data(), kPixelBytes, kPixelBytes * window.width());
    return {rgb.begin(), rgb.end()};
}

PassRenderer::PassRenderer(std::shared_ptr<const Scene> scene, const RenderSettings& settings,
                           const Plan& plan, int threads, Chooser choose)
    : m_settings(settings),
      m_choose(std::move(choose)),
      m_arena(threads),
      m_frame(plugin::makeFrame(settings, plan.tracePhotons, plan.errorScale)),
      m_pass(settings) {
    m_renderer = m_arena.execute(
        [&] { return std::make_unique<FrameRenderer>(std::move(scene), m_settings, plan); });
}

const Pass& PassRenderer::next() {
    m_arena.execute([&] {
        m_renderer->beginPass(m_passes, kNotCancelled, {});
        renderStrips();
    });
    m_frame.addPass(m_passes++, m_settings.window, m_pass.pixels, m_pass.weights);
    return m_pass;
}

std::vector<double> PassRenderer::beauty() const {
    return channelsOf(m_frame, m_renderer->layout().beauty);
}

// Whole atoms: the frame's sides are multiples of 8.
void PassRenderer::renderStrips() {
    const Rect& frame = m_settings.window;
    const auto channels = static_cast<std::size_t>(m_renderer->layout().count);
    const auto width = static_cast<std::size_t>(frame.width());
    tbb::parallel_for(std::int32_t{0}, (frame.height() + kRows - 1) / kRows, [&](std::int32_t i) {
        const std::int32_t y = frame.y0 + i * kRows;
        const Rect strip = intersect({frame.x0, y, frame.x1, y + kRows}, frame);
        const auto area = static_cast<std::size_t>(strip.area());
        const std::size_t first = static_cast<std::size_t>(i * kRows) * width;
        std::vector<SampleRun> runs(area);
        plugin::findSamples(m_settings, m_frame, m_passes, strip, runs);
        for (std::size_t k = 0; m_choose && k < area; ++k) m_choose(m_passes, first + k, runs[k]);
        std::ranges::transform(runs, m_pass.weights.begin() + static_cast<std::ptrdiff_t>(first),
                               [](const SampleRun& run) { return run.weight(); });
        m_renderer->renderRegion(
            strip, runs, std::span(m_pass.pixels).subspan(first * channels, area * channels),
            kNotCancelled);
    });
}

}  // namespace pm::bench
