// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// How fast the parts are: rays, photons, maps, look-ups, phases, random numbers; where there is a
// rival, side by side with it in one run. And what share of a camera sample's time each part has.
#include "tests/bench/speed/speed_bench.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <functional>
#include <utility>
#include <vector>

namespace pm::bench {
namespace {

int runProgram(int argc, char** argv) {
    static const std::vector<std::pair<std::string, std::function<void(Report&, int)>>> kParts = {
        {"rays", benchRays},     {"photons", benchPhotons}, {"queries", benchQueries},
        {"phases", benchPhases}, {"sampler", benchSampler}, {"split", benchSplit},
    };
    std::string csvFile, docsFile, only;
    int turns = 9;
    bool quick = false;
    CLI::App app("Speed of the integrator's parts");
    app.add_option("--csv", csvFile, "also write the tables to this CSV file");
    app.add_option("--docs", docsFile, "also put the tables into this Markdown file");
    app.add_option("--turns", turns, "timed turns of each rival (9)")->check(CLI::Range(1, 1000));
    app.add_flag("--quick", quick, "a third of the turns");
    app.add_option("--only", only, "one part: rays, photons, queries, phases, sampler or split")
        ->check(CLI::IsMember({"rays", "photons", "queries", "phases", "sampler", "split"}));
    CLI11_PARSE(app, argc, argv);
    if (quick) turns = std::max(1, turns / 3);
    try {
        std::vector<Report> reports;
        for (const auto& [name, part] : kParts)
            if (only.empty() || name == only)
                part(reports.emplace_back("pm_bench_speed " + name), turns);
        publish(reports, csvFile, docsFile);
        return 0;
    } catch (const std::exception& e) {
        fmt::print(stderr, "pm_bench_speed: {}\n", e.what());
        return 1;
    }
}

}  // namespace
}  // namespace pm::bench

int main(int argc, char** argv) {
    return pm::bench::runProgram(argc, argv);
}
