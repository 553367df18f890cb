// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// What a farm of 1 to 1,024 workers gains: costs are measured here, farms that are larger than the
// machine are replayed.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>

#include "integrator/values/error.h"
#include "tests/bench/farm/farm_costs.h"
#include "tests/bench/farm/farm_tables.h"
#include "tests/bench/plot/report.h"
#include "tests/bench/run/child_process.h"

namespace pm::bench {
namespace {

namespace fs = std::filesystem;

void measure(const fs::path& file, bool quick, int turns) {
    const TemporaryFolder folder;
    std::vector<std::string> words{"python3", "-B", PM_MEASURE_FARM, PM_HOST_FILE,
                                   fs::absolute(file).string()};
    if (quick) words.emplace_back("--quick");
    words.insert(words.end(), {"--turns", std::to_string(turns)});
    const fs::path log = folder.path() / "log";
    if (runChild(words, folder.path(), log).exitCode != 0)
        throw Error(Status::kInternal, "measure_farm.py: " + lastLineOf(log));
}

int runProgram(int argc, char** argv) {
    std::string csvFile, docsFile, costsFile, plotFile;
    bool quick = false;
    int turns = 1;
    CLI::App app("What a farm of any number of workers gains");
    app.add_option("--csv", csvFile, "also write the tables to this CSV file");
    app.add_option("--docs", docsFile, "also put the tables into this Markdown file");
    app.add_option("--plot", plotFile, "also draw efficiency over workers to this SVG file");
    app.add_option("--costs", costsFile,
                   "read the costs that were measured from this file; one that is not there is "
                   "written");
    app.add_option("--turns", turns, "of each real farm (1)")->check(CLI::Range(1, 100));
    app.add_flag("--quick", quick, "small frames");
    CLI11_PARSE(app, argc, argv);
    try {
        const TemporaryFolder folder;
        const fs::path costs =
            costsFile.empty() ? folder.path() / "costs.json" : fs::path(costsFile);
        if (!fs::exists(costs)) measure(costs, quick, turns);
        const MeasuredFarm farm = readMeasuredFarm(costs);
        Report report("pm_bench_farm");
        tellCosts(farm, report);
        tellReal(farm, report);
        tellScale(farm, report);
        tellNetworks(farm, report);
        tellPaper(farm, report);
        tellFaults(farm, report);
        if (!plotFile.empty()) plotScale(farm, plotFile);
        report.publish(csvFile, docsFile);
        return 0;
    } catch (const std::exception& e) {
        fmt::print(stderr, "pm_bench_farm: {}\n", e.what());
        return 1;
    }
}

}  // namespace
}  // namespace pm::bench

int main(int argc, char** argv) {
    return pm::bench::runProgram(argc, argv);
}
