// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// How far the three neutral scenes are from their references after how many seconds, here and by
// other renderers.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>

#include "tests/bench/error/error_report.h"

namespace pm::bench {
namespace {

int runProgram(int argc, char** argv) {
    ErrorBenchOptions options;
    CLI::App app("Error against time on three neutral scenes");
    app.add_option("--peers", options.peers, "folder of scenes.json and the references");
    app.add_option("--csv", options.csvFile, "also write the tables to this CSV file");
    app.add_option("--docs", options.docsFile,
                   "also put the tables into this Markdown file, plots into images/ beside it");
    app.add_option("--pictures", options.picturesFolder, "write pictures to this folder");
    app.add_option("--scenes", options.scenes, "of A, B, C (ABC)");
    app.add_option("--integrators", options.integrators, "photon, path or both (both)")
        ->check(CLI::IsMember({"photon", "path"}));
    app.add_option("--aa", options.aaLevels, "levels of anti-aliasing, each N or MIN:MAX (3:5 3)");
    app.add_option("--passes", options.passes, "passes of the longest render (256)");
    app.add_option("--seconds", options.seconds,
                   "no render is begun that takes longer on an idle machine (12)");
    app.add_option("--peer-seconds", options.peerSeconds, "the same for other renderers (30)");
    app.add_option("--threads", options.threads, "threads (2)");
    app.add_flag("--quick", options.quick,
                 "no other renderers (what was measured of them last is shown), no meshes, half "
                 "the seconds");
    CLI11_PARSE(app, argc, argv);
    if (!std::filesystem::exists(options.peers / "scenes.json")) {
        fmt::print(stderr,
                   "pm_bench_speed_error: skipped, no scenes.json in the folder of peers\n");
        return 0;
    }
    try {
        ErrorBench(options).run();
        return 0;
    } catch (const std::exception& e) {
        fmt::print(stderr, "pm_bench_speed_error: {}\n", e.what());
        return 1;
    }
}

}  // namespace
}  // namespace pm::bench

int main(int argc, char** argv) {
    return pm::bench::runProgram(argc, argv);
}
