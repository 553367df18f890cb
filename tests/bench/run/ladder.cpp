// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "tests/bench/run/ladder.h"

#include <nlohmann/json.hpp>

namespace pm::bench {

namespace {

using nlohmann::json;

// Adds `share` of a number of the statistics, when it is there and a number.
void addShare(const json& statistics, const char* key, double share, std::optional<double>& sum) {
    const auto found = statistics.find(key);
    if (found != statistics.end() && found->is_number())
        sum = sum.value_or(0) + found->get<double>() * share;
}

LadderStep stepOf(const NeutralScene& scene, const Yardstick& yardstick, int passes,
                  std::vector<HostedRender> renders) {
    LadderStep step;
    step.passes = passes;
    const double share = 1 / static_cast<double>(renders.size());
    for (std::size_t i = 0; i < renders.size(); ++i) {
        HostedRender& render = renders[i];
        const json statistics = json::parse(render.statistics);
        step.seconds += render.seconds * share;
        step.processorSeconds += render.processorSeconds * share;
        step.error += yardstick.relMse(render.rgb) * share;
        step.mean += yardstick.meanOver(render.rgb) * share;
        addShare(statistics, yardstick.dropped > 0 ? "relMseEstimateTrimmed" : "relMseEstimate",
                 share, step.estimated);
        addShare(statistics, "relMseEstimateBias", share, step.estimatedBias);
        step.samples = statistics.at("counters").at("cameraSamples").get<double>() /
                       (static_cast<double>(scene.size) * scene.size);
        step.pictures[i] = std::move(render.rgb);
    }
    if (renders.size() == 2)
        step.common = yardstick.commonError(step.pictures[0], step.pictures[1]);
    return step;
}

}  // namespace

Settings settingsFor(const LadderRequest& request, int passes, int seed) {
    const std::size_t colon = request.levels.find(':');
    return {{"integrator", request.integrator},
            {"aaLevel", request.levels.substr(0, colon)},
            {"aaLevelMost",
             colon == std::string::npos ? request.levels : request.levels.substr(colon + 1)},
            {"threads", std::to_string(request.threads)},
            {"passes", std::to_string(passes)},
            {"seed", std::to_string(seed)}};
}

std::vector<LadderStep> climb(const PluginHost& host, const NeutralScene& scene,
                              const Yardstick& yardstick, const LadderRequest& request) {
    std::vector<LadderStep> steps;
    for (int passes = 1; passes <= request.largestPasses; passes *= 2) {
        // Processor time, so that what else the machine does changes no budget.
        if (!steps.empty() && 2 * steps.back().processorSeconds > request.seconds * request.threads)
            break;
        std::vector<HostedRender> renders;
        for (int seed = 1; seed <= (request.twice ? 2 : 1); ++seed)
            renders.push_back(host.render(scene, settingsFor(request, passes, seed)));
        steps.push_back(stepOf(scene, yardstick, passes, std::move(renders)));
    }
    return steps;
}

}  // namespace pm::bench
