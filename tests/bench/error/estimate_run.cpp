// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "tests/bench/error/estimate_run.h"

#include <fmt/format.h>

#include <bit>
#include <fstream>

#include "plugin/session/frame_samples.h"
#include "tests/bench/run/pass_renderer.h"
#include "tests/bench/run/timing.h"

namespace pm::bench {

namespace {

void readPass(std::ifstream& kept, Pass& pass) {
    for (std::vector<float>* const values : {&pass.pixels, &pass.weights})
        kept.read(reinterpret_cast<char*>(values->data()),
                  static_cast<std::streamsize>(values->size() * sizeof(float)));
}

void writePass(const Pass& pass, std::ofstream& keep) {
    for (const std::vector<float>* const values : {&pass.pixels, &pass.weights})
        keep.write(reinterpret_cast<const char*>(values->data()),
                   static_cast<std::streamsize>(values->size() * sizeof(float)));
}

}  // namespace

RenderSettings judgedSettings(std::int32_t width, std::int32_t height, std::uint32_t passes,
                              std::uint64_t seed) {
    RenderSettings settings;
    settings.width = width;
    settings.height = height;
    settings.window = {0, 0, width, height};
    settings.passes = passes;
    settings.aaLevel = 3;
    settings.aaLevelMost = 5;
    settings.seed = seed;
    return settings;
}

template <typename UsePass>
void PassSource::forEachPass(const RenderSettings& settings, const UsePass& usePass) const {
    const std::string name = fmt::format("{}_{}_{}_aa{}-{}_x{}_k{}_n{}_seed{}.passes", m_key,
                                         static_cast<int>(settings.integrator), settings.width,
                                         settings.aaLevel, settings.aaLevelMost, settings.passes,
                                         settings.estimatePhotons, settings.photons, settings.seed);
    const std::filesystem::path file = m_folder / name, unfinished = m_folder / (name + ".part");
    if (!m_folder.empty() && std::filesystem::exists(file)) {
        std::ifstream kept(file, std::ios::binary);
        Pass pass(settings);
        for (std::uint32_t i = 0; i < settings.passes; ++i) {
            readPass(kept, pass);
            usePass(i, pass.pixels, pass.weights, 0.0);
        }
        return;
    }
    std::ofstream keep;
    if (!m_folder.empty()) keep.open(unfinished, std::ios::binary);
    double seconds = 0, start = processorSeconds();
    PassRenderer renderer(m_scene, settings, makePlan(*m_scene, settings), m_threads);
    for (std::uint32_t i = 0; i < settings.passes; ++i) {
        const Pass& pass = renderer.next();
        seconds += processorSeconds() - start;
        if (keep.is_open()) writePass(pass, keep);
        usePass(i, pass.pixels, pass.weights, seconds);
        start = processorSeconds();
    }
    keep.close();
    if (!m_folder.empty()) std::filesystem::rename(unfinished, file);
}

std::vector<Judged> PassSource::judged(const RenderSettings& settings) const {
    FrameStore store = plugin::makeFrame(settings, makePlan(*m_scene, settings).tracePhotons, {});
    std::vector<Judged> result;
    forEachPass(settings,
                [&](std::uint32_t pass, const auto& pixels, const auto& weights, double seconds) {
                    store.addPass(pass, settings.window, pixels, weights);
                    const std::uint32_t passes = pass + 1;
                    if (passes < 2 || !std::has_single_bit(passes)) return;
                    result.push_back({passes, channelsOf(store, channelLayout(settings).beauty),
                                      channelsOf(store, channelLayout(settings).emission),
                                      store.estimateError().value(), seconds});
                });
    return result;
}

Halves PassSource::halves(const RenderSettings& settings) const {
    FrameStore even = plugin::makeFrame(settings, true, {});
    FrameStore odd = plugin::makeFrame(settings, true, {});
    forEachPass(settings, [&](std::uint32_t pass, const auto& pixels, const auto& weights, double) {
        (pass % 2 == 0 ? even : odd).addPass(pass, settings.window, pixels, weights);
    });
    const std::int32_t beauty = channelLayout(settings).beauty;
    const std::int32_t emission = channelLayout(settings).emission;
    return {channelsOf(even, beauty), channelsOf(odd, beauty), channelsOf(even, emission),
            channelsOf(odd, emission)};
}

}  // namespace pm::bench
