// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "tests/bench/run/render_run.h"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <bit>

#include "tests/bench/run/timing.h"

namespace pm::bench {

namespace {

// As small as the pieces that the library shares out at the end of a pass.
constexpr std::int32_t kBucket = 8;

// Sums of radiance over passes, weighted by samples.
struct Sums {
    std::vector<double> radiance, weight;

    explicit Sums(std::size_t pixels) : radiance(3 * pixels), weight(pixels) {}
    void add(std::size_t pixel, const float* rgb, float samples) {
        for (std::size_t c = 0; c < 3; ++c)
            radiance[3 * pixel + c] += static_cast<double>(rgb[c]) * static_cast<double>(samples);
        weight[pixel] += static_cast<double>(samples);
    }
    std::vector<double> mean() const {
        std::vector<double> result(radiance);
        for (std::size_t i = 0; i < result.size(); ++i)
            result[i] = weight[i / 3] > 0 ? result[i] / weight[i / 3] : 0;
        return result;
    }
};

std::vector<double> meanOf(const Sums& a, const Sums& b) {
    Sums both = a;
    for (std::size_t i = 0; i < both.radiance.size(); ++i) both.radiance[i] += b.radiance[i];
    for (std::size_t i = 0; i < both.weight.size(); ++i) both.weight[i] += b.weight[i];
    return both.mean();
}

void renderPass(const FrameRenderer& renderer, const RenderSettings& settings,
                const std::atomic<bool>& cancelled, Sums& sums) {
    const Rect frame = settings.window;
    const auto channels = static_cast<std::size_t>(renderer.layout().count);
    const std::int32_t columns = (frame.width() + kBucket - 1) / kBucket;
    const std::int32_t rows = (frame.height() + kBucket - 1) / kBucket;
    tbb::parallel_for(std::int32_t{0}, columns * rows, [&](std::int32_t bucket) {
        const std::int32_t x = frame.x0 + bucket % columns * kBucket;
        const std::int32_t y = frame.y0 + bucket / columns * kBucket;
        const Rect region = intersect({x, y, x + kBucket, y + kBucket}, frame);
        const auto area = static_cast<std::size_t>(region.area());
        std::vector<float> pixels(area * channels), weights(area);
        renderer.renderRegion(region, pixels, weights, cancelled);
        for (std::size_t i = 0; i < area; ++i) {
            const auto width = static_cast<std::size_t>(region.width());
            const std::size_t row = static_cast<std::size_t>(region.y0 - frame.y0) + i / width;
            const std::size_t column = static_cast<std::size_t>(region.x0 - frame.x0) + i % width;
            sums.add(row * static_cast<std::size_t>(frame.width()) + column,
                     pixels.data() + i * channels, weights[i]);
        }
    });
}

}  // namespace

RenderCounters renderPasses(const std::shared_ptr<const Scene>& scene,
                            const RenderSettings& settings, int threads,
                            const std::function<void(const Accumulated&)>& after) {
    tbb::task_arena arena(threads);
    const std::atomic<bool> cancelled{false};
    const auto pixels = static_cast<std::size_t>(settings.window.area());
    Sums even(pixels), odd(pixels);
    Accumulated so;
    double cpuStart = processorSeconds();
    auto start = std::chrono::steady_clock::now();
    FrameRenderer renderer(scene, settings);
    for (std::uint32_t pass = 0; pass < settings.passes; ++pass) {
        arena.execute([&] {
            renderer.beginPass(pass, cancelled, {});
            so.renderSeconds += secondsOf(
                [&] { renderPass(renderer, settings, cancelled, pass % 2 == 0 ? even : odd); });
        });
        if (!std::has_single_bit(pass + 1)) continue;
        so.passes = pass + 1;
        so.wallSeconds += secondsSince(start);
        so.processorSeconds += processorSeconds() - cpuStart;
        so.mean = meanOf(even, odd);
        so.evenMean = even.mean();
        so.oddMean = odd.mean();
        after(so);
        cpuStart = processorSeconds();
        start = std::chrono::steady_clock::now();
    }
    return renderer.counters();
}

}  // namespace pm::bench
