// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "tests/bench/estimate_run.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <bit>
#include <fstream>

#include "integrator/transport/frame_renderer.h"
#include "scheduler/frame_store.h"

namespace pm::bench {

namespace {

constexpr std::int32_t kRows = 8;  // of a strip

// One pass of a whole frame: the floats of ChannelLayout, and the samples of each pixel.
struct Pass {
    std::vector<float> pixels, weights;

    Pass(std::size_t area, std::int32_t channels)
        : pixels(area * static_cast<std::size_t>(channels)), weights(area) {}
};

void renderStrips(const FrameRenderer& renderer, const Rect& frame, Pass& pass) {
    const auto channels = static_cast<std::size_t>(renderer.layout().count);
    const auto width = static_cast<std::size_t>(frame.width());
    const std::atomic<bool> cancelled{false};
    tbb::parallel_for(std::int32_t{0}, (frame.height() + kRows - 1) / kRows, [&](std::int32_t i) {
        const std::int32_t y = frame.y0 + i * kRows;
        const Rect strip = intersect({frame.x0, y, frame.x1, y + kRows}, frame);
        const auto area = static_cast<std::size_t>(strip.area());
        const std::size_t first = static_cast<std::size_t>(i * kRows) * width;
        renderer.renderRegion(strip,
                              std::span(pass.pixels).subspan(first * channels, area * channels),
                              std::span(pass.weights).subspan(first, area), cancelled);
    });
}

template <typename Stream, typename Move>
void movePass(Stream& stream, Pass& pass, Move move) {
    for (std::vector<float>* const values : {&pass.pixels, &pass.weights})
        (stream.*move)(reinterpret_cast<char*>(values->data()),
                       static_cast<std::streamsize>(values->size() * sizeof(float)));
}

std::vector<double> channelsOf(const FrameStore& store, std::int32_t first) {
    const Rect& window = store.window();
    std::vector<float> rgb(3 * static_cast<std::size_t>(window.area()));
    constexpr std::int64_t kPixelBytes = 3 * sizeof(float);
    store.read(window, first, 3, rgb.data(), kPixelBytes, kPixelBytes * window.width());
    return {rgb.begin(), rgb.end()};
}

FrameStore storeFor(const RenderSettings& settings) {
    const ChannelLayout layout = channelLayout(settings);
    return {settings.window, layout.count, layout.beauty, layout.biasProbe, layout.emission};
}

}  // namespace

template <typename UsePass>
void PassSource::forEachPass(const RenderSettings& settings, const UsePass& usePass) const {
    Pass pass(static_cast<std::size_t>(settings.window.area()), channelLayout(settings).count);
    const std::string name = fmt::format(
        "{}_{}_{}_aa{}_x{}_k{}_seed{}.passes", m_key, static_cast<int>(settings.integrator),
        settings.width, settings.aaLevel, settings.passes, settings.estimatePhotons, settings.seed);
    const std::filesystem::path file = m_folder / name, unfinished = m_folder / (name + ".part");
    if (!m_folder.empty() && std::filesystem::exists(file)) {
        std::ifstream kept(file, std::ios::binary);
        for (std::uint32_t i = 0; i < settings.passes; ++i) {
            movePass(kept, pass, &std::ifstream::read);
            usePass(i, pass.pixels, pass.weights);
        }
        return;
    }
    std::ofstream keep;
    if (!m_folder.empty()) keep.open(unfinished, std::ios::binary);
    tbb::task_arena arena(m_threads);
    const std::atomic<bool> cancelled{false};
    FrameRenderer renderer(m_scene, settings);
    for (std::uint32_t i = 0; i < settings.passes; ++i) {
        arena.execute([&] {
            renderer.beginPass(i, cancelled, {});
            renderStrips(renderer, settings.window, pass);
        });
        if (keep.is_open()) movePass(keep, pass, &std::ofstream::write);
        usePass(i, pass.pixels, pass.weights);
    }
    keep.close();
    if (!m_folder.empty()) std::filesystem::rename(unfinished, file);
}

std::vector<Judged> PassSource::judged(const RenderSettings& settings) const {
    FrameStore store = storeFor(settings);
    std::vector<Judged> result;
    forEachPass(settings, [&](std::uint32_t pass, const auto& pixels, const auto& weights) {
        store.addPass(settings.window, pixels, weights);
        const std::uint32_t passes = pass + 1;
        if (passes < 2 || !std::has_single_bit(passes)) return;
        result.push_back({passes, channelsOf(store, channelLayout(settings).beauty),
                          channelsOf(store, channelLayout(settings).emission),
                          store.estimateError().value()});
    });
    return result;
}

Halves PassSource::halves(const RenderSettings& settings) const {
    FrameStore even = storeFor(settings), odd = storeFor(settings);
    forEachPass(settings, [&](std::uint32_t pass, const auto& pixels, const auto& weights) {
        (pass % 2 == 0 ? even : odd).addPass(settings.window, pixels, weights);
    });
    const std::int32_t beauty = channelLayout(settings).beauty;
    const std::int32_t emission = channelLayout(settings).emission;
    return {channelsOf(even, beauty), channelsOf(odd, beauty), channelsOf(even, emission),
            channelsOf(odd, emission)};
}

}  // namespace pm::bench
