// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "tests/bench/paper/paper_levels.h"

#include <fmt/format.h>

#include <cstdio>
#include <nlohmann/json.hpp>

#include "tests/bench/run/timing.h"

namespace pm::bench {

namespace {

// The paper's four (Level-0-0 is fixed too), what else is fixed, and what the library does unless
// told otherwise.
const std::vector<LevelRange> kRanges = {{0, 0}, {0, 1}, {0, 2}, {0, 3},
                                         {1, 1}, {2, 2}, {3, 3}, {3, 5}};
constexpr int kReferenceLevel = 4, kReferenceSeed = 1001, kPasses = 4;

Settings settingsOf(const LevelRange& range, int passes, int seed, int threads) {
    return {{"integrator", "photon"},
            {"aaLevel", std::to_string(range.least)},
            {"aaLevelMost", std::to_string(range.most)},
            {"passes", std::to_string(passes)},
            {"seed", std::to_string(seed)},
            {"threads", std::to_string(threads)}};
}

double samplesOf(const HostedRender& render) {
    const auto statistics = nlohmann::json::parse(render.statistics);
    return statistics.at("counters").at("cameraSamples").get<double>() /
           (static_cast<double>(render.rgb.size()) / 3);
}

// Two independent halves, so that the noise of their mean is known: a quarter of what they differ.
void makeReference(const PluginHost& host, const PaperLevelsOptions& options, SceneLevels& levels) {
    const int side = levels.scene.scene.size;
    std::vector<double> halves[2];
    for (int i = 0; i < 2; ++i)
        halves[i] = host.render(levels.scene.scene, settingsOf({kReferenceLevel, kReferenceLevel},
                                                               options.referencePasses,
                                                               kReferenceSeed + i, options.threads))
                        .rgb;
    levels.reference = {side, side, halves[0]};
    for (std::size_t i = 0; i < halves[0].size(); ++i)
        levels.reference.rgb[i] = (halves[0][i] + halves[1][i]) / 2;
    levels.referenceNoise = Yardstick{levels.reference.rgb}.relMse(halves[0]);
    fmt::print(stderr, "  {}: reference, its noise {:.2e}\n", levels.scene.name,
               levels.referenceNoise);
}

void addTurn(const PluginHost& host, const PaperLevelsOptions& options, int turn,
             const SceneLevels& levels, LevelRun& run) {
    const HostedRender render =
        host.render(levels.scene.scene, settingsOf(run.range, kPasses, turn + 1, options.threads));
    run.seconds.push_back(render.seconds);
    run.processorSeconds.push_back(render.processorSeconds);
    run.errors.push_back(Yardstick{levels.reference.rgb}.relMse(render.rgb));
    run.samples = samplesOf(render);
    if (turn == 0) run.picture = {levels.scene.scene.size, levels.scene.scene.size, render.rgb};
    fmt::print(stderr, "  {}: {}, turn {}\n", levels.scene.name, run.range.name(), turn + 1);
}

}  // namespace

std::string LevelRange::name() const {
    return fmt::format("Level-{}-{}", least, most);
}

SceneLevels runPaperLevels(const PluginHost& host, const PaperScene& scene,
                           const PaperLevelsOptions& options) {
    SceneLevels levels{scene, {}, 0, {}};
    const double least = host.least("aaLevel");
    for (const LevelRange& range : kRanges)
        if (range.least >= least)
            levels.runs.push_back({range, {}, {}, {}, 0, {}});
        else
            fmt::print(stderr, "  {}: left out, the library's levels begin at {}\n", range.name(),
                       least);
    makeReference(host, options, levels);
    for (int turn = 0; turn < options.turns; ++turn)
        for (std::size_t i = 0; i < levels.runs.size(); ++i)
            addTurn(host, options, turn, levels,
                    levels.runs[(i + static_cast<std::size_t>(turn)) % levels.runs.size()]);
    return levels;
}

}  // namespace pm::bench
