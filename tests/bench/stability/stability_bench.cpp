// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Sweeps of numerical stability, and docs/stability.md of them.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <exception>
#include <string>
#include <vector>

#include "tests/bench/run/timing.h"
#include "tests/bench/stability/sweep.h"
#include "tests/bench/stability/sweep_page.h"

namespace pm::bench {
namespace {

struct Options {
    int seeds = 8;
    std::string only, page;
    bool quick = false, points = false;
};

std::vector<SweepResult> runAll(const Options& options) {
    std::vector<SweepResult> results;
    for (Sweep& sweep : allSweeps()) {
        const std::string name = sweep.kind + " " + sweep.name + " " + sweep.variant;
        if (name.find(options.only) == std::string::npos) continue;
        const double before = processorSeconds();
        results.push_back(run(options.quick ? shortened(sweep) : sweep, options.seeds));
        const SweepResult& result = results.back();
        fmt::print("{}  {:.1f} s\n", outcomeLine(result, limitOfChance(result.points.size())),
                   processorSeconds() - before);
        if (options.points)
            for (const SweepPoint& p : result.points)
                fmt::print("    {:<10.3g} {:.7g} for {:.7g}: {:.3g} +- {:.2g}, z {:.1f}\n", p.value,
                           p.measured, p.expected, p.error, p.standardError, p.z);
        std::fflush(stdout);
    }
    return results;
}

int runProgram(int argc, char** argv) {
    Options options;
    CLI::App app("Sweeps of numerical stability: what should not change with a parameter");
    app.add_option("--seeds", options.seeds, "renders at each value (8)")
        ->check(CLI::Range(2, 999));
    app.add_option("--only", options.only, "sweeps with this in 'KIND NAME VARIANT'");
    app.add_option("--docs", options.page,
                   "page to write, with lab/*.csv and images/* beside it; not of a part of them");
    app.add_flag("--points", options.points, "print all points, too");
    app.add_flag("--quick", options.quick, "three values of each and 3 seeds; writes no page");
    CLI11_PARSE(app, argc, argv);
    if (options.quick) options.seeds = 3;
    try {
        const std::vector<SweepResult> results = runAll(options);
        if (!options.page.empty() && !options.quick && options.only.empty())
            writeSweepPage(options.page, results);
        return 0;
    } catch (const std::exception& e) {
        fmt::print(stderr, "pm_bench_stability: {}\n", e.what());
        return 1;
    }
}

}  // namespace
}  // namespace pm::bench

int main(int argc, char** argv) {
    return pm::bench::runProgram(argc, argv);
}
