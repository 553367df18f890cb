// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// The experiments of "Hilbert Curve Based Bucket Ordering for Global Illumination" (Yavuz, Tugrul
// and Tosun 2010, section 6) made again: its Fig. 9, 10 and 11.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <filesystem>

#include "scheduler/buckets/available_threads.h"
#include "tests/bench/paper/paper_claims.h"
#include "tests/bench/paper/paper_levels.h"
#include "tests/bench/paper/paper_orders.h"

namespace pm::bench {
namespace {

struct Options {
    std::string csvFile, docsFile, pictures, only, plugin = PM_PLUGIN_FILE;
    int turns = 8, referencePasses = 12;
    double bucketSeconds = 0;
    bool quick = false;
};

void addOptions(CLI::App& app, Options& options) {
    app.add_option("--csv", options.csvFile, "also write the tables to this CSV file");
    app.add_option("--docs", options.docsFile,
                   "also put the tables into this Markdown file, CSV files beside it and plots "
                   "into images/ there");
    app.add_option("--pictures", options.pictures, "write each picture of Fig. 11 to this folder");
    app.add_option("--turns", options.turns, "turns of the orders (8)")->check(CLI::Range(1, 1000));
    app.add_option("--bucket-seconds", options.bucketSeconds,
                   "that the replay adds to each bucket, as sending it through a network would (0)")
        ->check(CLI::Range(0.0, 1e3));
    app.add_option("--only", options.only, "one part: orders or levels")
        ->check(CLI::IsMember({"orders", "levels"}));
    app.add_option("--reference-passes", options.referencePasses,
                   "of either half of the levels' references (12)")
        ->check(CLI::Range(1, 10000));
    app.add_option("--plugin", options.plugin,
                   "the library that renders the levels (this build's)");
    app.add_flag("--quick", options.quick, "2 turns of the orders, 1 of the levels");
}

void benchOrders(Report& report, const Options& options, const std::filesystem::path& folder) {
    PaperOrdersOptions orders;
    orders.turns = options.quick ? 2 : options.turns;
    orders.workers = std::min(availableThreads(), kPaperWorkers);
    orders.bucketSeconds = options.bucketSeconds;
    std::vector<SceneOrders> found;
    for (const PaperScene& scene : paperScenes()) found.push_back(runPaperOrders(scene, orders));
    if (options.bucketSeconds > 0)
        report.paragraph(fmt::format("The replay adds {} s to each bucket, as a network would.",
                                     options.bucketSeconds));
    reportPaperOrders(report, found);
    if (options.docsFile.empty()) return;
    writePaperOrders(folder, found);
    report.paragraph("![Seconds of a pass by workers and order](images/paper_orders.svg)");
}

void benchLevels(Report& report, const Options& options, const std::filesystem::path& folder) {
    const PluginHost host(options.plugin);
    PaperLevelsOptions levels;
    levels.threads = availableThreads();
    levels.turns = options.quick ? 1 : 3;
    levels.referencePasses =
        options.quick ? std::min(3, options.referencePasses) : options.referencePasses;
    std::vector<SceneLevels> found;
    for (const PaperScene& scene : paperScenes())
        found.push_back(runPaperLevels(host, scene, levels));
    reportPaperLevels(report, found);
    if (!options.pictures.empty()) writePaperPictures(options.pictures, found);
    if (options.docsFile.empty()) return;
    writePaperLevels(folder, found);
    report.paragraph("![Processor seconds by range of levels](images/paper_levels.svg)");
    report.paragraph("![Error against time by range of levels](images/paper_levels_error.svg)");
    report.paragraph(
        "![The scenes, and for each range of levels some of its pixels](images/paper_levels.png)");
    std::string columns;
    for (const LevelRun& run : found[0].runs)
        if (isPictured(run, found[0])) columns += ", " + run.range.name();
    report.paragraph("Fig. 11: each row a scene; the reference, then 64 x 64 pixels of each of" +
                     columns.substr(1) + ", three times as large.");
}

int runProgram(int argc, char** argv) {
    Options options;
    CLI::App app("The experiments of the paper: orders and workers, levels of anti-aliasing");
    addOptions(app, options);
    CLI11_PARSE(app, argc, argv);
    try {
        const std::filesystem::path folder = std::filesystem::path(options.docsFile).parent_path();
        if (!options.docsFile.empty()) std::filesystem::create_directories(folder / "images");
        std::vector<Report> reports;
        const auto add = [&](const std::string& part, const auto& bench) {
            if (options.only.empty() || options.only == part)
                bench(reports.emplace_back("pm_bench_paper " + part), options, folder);
        };
        add("orders", benchOrders);
        add("levels", benchLevels);
        publish(reports, options.csvFile, options.docsFile);
        return 0;
    } catch (const std::exception& e) {
        fmt::print(stderr, "pm_bench_paper: {}\n", e.what());
        return 1;
    }
}

}  // namespace
}  // namespace pm::bench

int main(int argc, char** argv) {
    return pm::bench::runProgram(argc, argv);
}
