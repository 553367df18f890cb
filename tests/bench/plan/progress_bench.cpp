// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// How right the remaining time is that a render tells: over the time that then remained, when so
// much of its time had passed. Renders by pm_host, which tells it once a second at most.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "integrator/values/error.h"
#include "tests/bench/plot/report.h"
#include "tests/bench/run/child_process.h"

namespace pm::bench {

namespace {

constexpr std::array kShares = {0.1, 0.25, 0.5, 0.75, 0.9};

// What a line of --progress json says.
struct Told {
    double elapsed, remaining;  // seconds; remaining NaN where it is not told
};

struct Case {
    std::string name, scene;
    std::vector<std::string> arguments;
};

std::vector<Case> cases(bool quick) {
    const std::string cornell = "cornell_box/cornell_box.obj";
    const std::string glass = "caustic_glass/caustic_glass.obj";
    const std::vector<std::string> ways =
        quick ? std::vector<std::string>{"--passes 4"}
              : std::vector<std::string>{"--passes 4", "--passes 12", "--passes 6 --aa 3",
                                         "--time-limit 20", "--error-target 1e-3"};
    std::vector<Case> all;
    for (const auto& [name, scene] : {std::pair{"diffuse box", cornell}, {"caustic", glass}})
        for (const std::string& way : ways) {
            Case one{fmt::format("{}, {}", name, way), scene, {}};
            for (std::size_t at = 0; at < way.size();) {
                const std::size_t end = std::min(way.find(' ', at), way.size());
                one.arguments.push_back(way.substr(at, end - at));
                at = end + 1;
            }
            all.push_back(std::move(one));
        }
    return all;
}

std::vector<Told> linesOf(const std::filesystem::path& log) {
    std::vector<Told> told;
    std::ifstream stream(log);
    for (std::string line; std::getline(stream, line);) {
        if (!line.starts_with("{\"progress\"")) continue;
        const auto json = nlohmann::json::parse(line);
        const auto& remaining = json.at("remaining_seconds");
        told.push_back({json.at("elapsed_seconds").get<double>(),
                        remaining.is_null() ? std::nan("") : remaining.get<double>()});
    }
    return told;
}

// Told over true at each share of the time that the render took; NaN where nothing was told.
std::vector<double> ratiosOf(const std::vector<Told>& told) {
    std::vector<double> ratios;
    if (told.empty()) return std::vector<double>(kShares.size(), std::nan(""));
    // The first and last lines come when a render begins and ends.
    const double start = told.front().elapsed, end = told.back().elapsed;
    for (const double share : kShares) {
        const double when = start + share * (end - start);
        // The line before, taken on to the moment.
        const auto after = std::find_if(told.begin(), told.end(),
                                        [when](const Told& line) { return line.elapsed > when; });
        if (after == told.begin()) {
            ratios.push_back(std::nan(""));
            continue;
        }
        const Told& line = *std::prev(after);
        ratios.push_back((line.remaining - (when - line.elapsed)) / (end - when));
    }
    return ratios;
}

std::vector<double> measure(const Case& one, const std::string& size) {
    const TemporaryFolder folder;
    std::vector<std::string> arguments{PM_HOST_FILE, std::string(PM_SCENES) + "/" + one.scene,
                                       "--size",     size,
                                       "-o",         "a.exr",
                                       "--progress", "json"};
    arguments.insert(arguments.end(), one.arguments.begin(), one.arguments.end());
    const std::filesystem::path log = folder.path() / "log";
    const ChildResult result = runChild(arguments, folder.path(), log);
    if (result.exitCode != 0)
        throw Error(Status::kInternal, fmt::format("{}: {}", one.name, lastLineOf(log)));
    return ratiosOf(linesOf(log));
}

std::string cellOf(std::vector<double> ratios) {
    std::erase_if(ratios, [](double ratio) { return std::isnan(ratio); });
    return ratios.empty() ? "not told" : show(spreadOf(ratios));
}

int runProgram(int argc, char** argv) {
    std::string csvFile, docsFile, size = "384x288";
    int turns = 5;
    bool quick = false;
    CLI::App app("How right the remaining time is");
    app.add_option("--csv", csvFile, "also write the tables to this CSV file");
    app.add_option("--docs", docsFile, "also put the tables into this Markdown file");
    app.add_option("--size", size, "of the pictures (384x288)");
    app.add_option("--turns", turns, "renders of each kind (5)")->check(CLI::Range(1, 1000));
    app.add_flag("--quick", quick, "two kinds, 3 renders of each");
    CLI11_PARSE(app, argc, argv);
    try {
        if (quick) turns = std::min(turns, 3);
        Report report("pm_bench_progress");
        report.table(fmt::format("Remaining time that is told over the true one, {} pixels, {} "
                                 "renders of each kind: median and quartiles",
                                 size, turns),
                     {"render", "at 10 %", "25 %", "50 %", "75 %", "90 %"});
        std::vector<std::vector<double>> all(kShares.size());
        const auto row = [&](const std::string& name,
                             const std::vector<std::vector<double>>& ratios) {
            std::vector<std::string> cells{name};
            for (const std::vector<double>& at : ratios) cells.push_back(cellOf(at));
            report.row(cells);
        };
        for (const Case& one : cases(quick)) {
            std::vector<std::vector<double>> ratios(kShares.size());
            for (int turn = 0; turn < turns; ++turn) {
                const std::vector<double> found = measure(one, size);
                for (std::size_t i = 0; i < kShares.size(); ++i) {
                    ratios[i].push_back(found[i]);
                    all[i].push_back(found[i]);
                }
            }
            row(one.name, ratios);
        }
        row("all", all);
        report.publish(csvFile, docsFile);
        return 0;
    } catch (const std::exception& e) {
        fmt::print(stderr, "pm_bench_progress: {}\n", e.what());
        return 1;
    }
}

}  // namespace

}  // namespace pm::bench

int main(int argc, char** argv) {
    return pm::bench::runProgram(argc, argv);
}
