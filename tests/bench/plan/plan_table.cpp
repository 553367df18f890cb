// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "tests/bench/plan/plan_table.h"

#include <fmt/format.h>

#include <cmath>

namespace pm::bench {

namespace {

constexpr const char* kSetting = "plan";
constexpr const char* kForced = "everything";
constexpr int kSeeds = 4, kPasses = 4;

// Mean, and its standard error from the spread.
struct Mean {
    double value = 0, standardError = 0;
};

Mean meanOf(const std::vector<double>& values) {
    const auto count = static_cast<double>(values.size());
    Mean mean;
    for (const double v : values) mean.value += v / count;
    double squares = 0;
    for (const double v : values) squares += (v - mean.value) * (v - mean.value);
    mean.standardError = std::sqrt(squares / (count - 1) / count);
    return mean;
}

}  // namespace

bool beginPlanTable(const PluginHost& host, Report& report) {
    if (!host.offers(kSetting, kForced)) {
        report.paragraph(fmt::format(
            "What the plan earns: not measured, there is no setting `{}` with a choice `{}`.",
            kSetting, kForced));
        return false;
    }
    report.table(fmt::format("What the plan earns: all parts forced on (`{}` = `{}`) against the "
                             "plan's choice; {} passes, {} seeds, whose spread gives the +-",
                             kSetting, kForced, kPasses, kSeeds),
                 {"scene", "processor seconds, plan", "processor seconds, everything",
                  "everything / plan", "difference of the pictures' means"});
    return true;
}

void addPlanRow(const PluginHost& host, const NeutralScene& scene, const Yardstick& yardstick,
                const LadderRequest& request, Report& report) {
    double planned = 0, forced = 0;
    std::vector<double> differences;
    for (int seed = 1; seed <= kSeeds; ++seed) {
        Settings settings = settingsFor(request, kPasses, seed);
        const HostedRender byPlan = host.render(scene, settings);
        settings[kSetting] = kForced;
        const HostedRender everything = host.render(scene, settings);
        planned += byPlan.processorSeconds / kSeeds;
        forced += everything.processorSeconds / kSeeds;
        differences.push_back(yardstick.meanOver(everything.rgb) - yardstick.meanOver(byPlan.rgb));
    }
    const Mean mean = meanOf(differences);
    report.row({scene.name, show(planned), show(forced), show(forced / planned),
                fmt::format("{:+.3f} % +- {:.3f} %", 100 * mean.value, 100 * mean.standardError)});
}

}  // namespace pm::bench
