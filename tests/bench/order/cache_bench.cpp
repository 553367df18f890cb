// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// What order gains where memory is short: misses and time of bounded caches, rendered and replayed.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cstdio>
#include <map>

#include "scheduler/buckets/bucket_order.h"
#include "tests/bench/order/cache_rendering.h"
#include "tests/bench/order/cache_replay.h"
#include "tests/bench/order/cache_scenes.h"
#include "tests/bench/plot/log_plot.h"
#include "tests/bench/plot/ratios.h"
#include "tests/bench/plot/report.h"

namespace pm::bench {
namespace {

constexpr std::array<std::uint64_t, 6> kShares{32, 16, 8, 4, 2, 1};  // of the working set
constexpr std::uint32_t kStoreMicroseconds = 1000;
constexpr int kRandomSeeds = 5;

// Means over seeds where the order has some.
double missesOf(CacheRendering& bench, const std::string& order, const CacheRules& rules) {
    const int seeds = order == "random" ? kRandomSeeds : 1;
    double sum = 0;
    for (int seed = 1; seed <= seeds; ++seed)
        sum += static_cast<double>(
            replayCaches(bench.trace(), bench.cellsOf(order, static_cast<std::uint64_t>(seed)),
                         rules)
                .misses);
    return sum / seeds;
}

void tellMisses(Report& report, CacheRendering& bench, const std::string& plotFile) {
    std::vector<std::string> header{"order"};
    for (const std::uint64_t share : kShares) header.push_back(fmt::format("1/{}", share));
    for (const int threads : {1, 2}) {
        report.table(
            fmt::format("{}: misses by size of the cache, as a share of the working set "
                        "({:.0f} MiB, {} {}), replayed, {} thread{}",
                        bench.scene().name, static_cast<double>(bench.workingSet()) / 0x1p20,
                        bench.trace().bytes.size(), bench.scene().unit, threads,
                        threads > 1 ? "s" : ""),
            header);
        LogPlot plot;
        plot.title = bench.scene().name + ": misses by size of the cache";
        plot.xLabel = "cache over working set";
        plot.yLabel = "misses";
        for (const BucketOrder& order : bucketOrders()) {
            std::vector<std::string> row{std::string(order.name)};
            PlotLine line{std::string(order.name), {}, false};
            for (const std::uint64_t share : kShares) {
                const double misses =
                    missesOf(bench, std::string(order.name),
                             {.budget = bench.budgetOf(share), .threads = threads});
                row.push_back(fmt::format("{:.0f}", misses));
                line.points.emplace_back(1.0 / static_cast<double>(share), misses);
            }
            report.row(row);
            plot.lines.push_back(std::move(line));
        }
        if (threads == 1 && !plotFile.empty()) writeSvg(plotFile, plot);
    }
}

void tellUsers(Report& report, std::vector<std::unique_ptr<CacheRendering>>& benches) {
    report.table("Whose misses they are, Hilbert's order, a cache of an eighth of the working set",
                 {"scene", "camera", "lamps", "paths that go on", "gather rays",
                  "before the buckets, by photons"});
    for (const auto& bench : benches) {
        const CacheReplay all =
            replayCaches(bench->trace(), bench->cellsOf("hilbert"), {.budget = bench->budgetOf(8)});
        std::vector<std::string> row{bench->scene().name};
        const double misses = static_cast<double>(all.misses);
        for (std::size_t user = 0; user < static_cast<std::size_t>(CacheUser::kPhoton); ++user)
            row.push_back(
                fmt::format("{:.1f} %", 100.0 * static_cast<double>(all.missesOf[user]) / misses));
        const std::uint64_t byPhotons = bench->missesOfPhotons(bench->budgetOf(8));
        row.push_back(fmt::format("{}, {:.2f} times as many", byPhotons,
                                  static_cast<double>(byPhotons) / misses));
        report.row(row);
    }
}

// What is won back of what rays miss that scatter, or could be.
void tellRemedies(Report& report, CacheRendering& bench) {
    constexpr std::array<CacheUser, 1> kGather{CacheUser::kGather};
    constexpr std::array<CacheUser, 2> kBoth{CacheUser::kGather, CacheUser::kShadow};
    constexpr std::uint64_t kCoarser = 16;  // triangles: a quarter of the rate
    report.table(
        bench.scene().name +
            ": won back, or could be; Hilbert's order, a cache of an eighth of the working "
            "set",
        {"remedy", "", "misses", "misses over none"});
    const CacheTrace& plain = bench.roomyTrace();
    const std::uint64_t budget = std::max(plain.workingSet() / 8, bench.scene().leastBudget);
    double none = 0;
    const auto tell = [&](const std::string& remedy, const char* how, std::uint64_t misses) {
        if (none == 0) none = static_cast<double>(misses);
        report.row({remedy, how, std::to_string(misses),
                    fmt::format("{:.2f}", static_cast<double>(misses) / none)});
    };
    const auto replay = [&](const std::string& remedy, const CacheTrace& changed) {
        tell(remedy, "replayed",
             replayCaches(changed, bench.cellsOf("hilbert"), {.budget = budget}).misses);
    };
    replay("none", plain);
    if (bench.scene().photons) replay("sites filled before, in the map's order", bench.trace());
    replay("a bucket's rays batched: each value once", batched(plain));
    if (bench.scene().groups) {
        replay("gather rays see groups of a quarter of the rate",
               coarsened(plain, kGather, kCoarser));
        replay("gather and shadow rays do", coarsened(plain, kBoth, kCoarser));
    }
    if (!bench.scene().remedied) return;
    none = 0;
    tell("none", "rendered", bench.run({.budget = budget}).misses);
    CacheRendering remedied(bench.scene().remedied());
    tell(bench.scene().remedy, "rendered", remedied.run({.budget = budget}).misses);
}

struct TimedRow {
    std::uint64_t share;
    int threads;
    std::uint32_t pause;
};
// What a miss costs here at three sizes of the cache, and what it would through a network at one.
std::vector<TimedRow> timedRows() {
    std::vector<TimedRow> rows{{32, 1, 0}};
    for (const std::uint64_t share : {8u, 1u})
        for (const int threads : {1, 2}) rows.push_back({share, threads, 0});
    for (const int threads : {1, 2}) rows.push_back({8, threads, kStoreMicroseconds});
    return rows;
}

// Of the first order of `played`, its times, misses and the replay's; then the others' times over
// its own.
std::vector<std::string> timed(CacheRendering& bench, const std::vector<std::string>& played,
                               const TimedRow& row, int turns) {
    const std::uint64_t budget = std::max(bench.budgetOf(row.share), bench.scene().leastBudget);
    std::vector<std::vector<double>> seconds(played.size()), misses(played.size());
    for (int turn = 0; turn < turns; ++turn) {
        for (std::size_t i = 0; i < played.size(); ++i) {
            const std::size_t at = (static_cast<std::size_t>(turn) + i) % played.size();
            const CacheRun run = bench.run({played[at], budget, row.threads, row.pause});
            seconds[at].push_back(run.seconds);
            misses[at].push_back(static_cast<double>(run.misses));
        }
    }
    std::vector<std::string> cells{
        fmt::format("1/{} ({:.0f} MiB)", row.share, static_cast<double>(budget) / 0x1p20),
        std::to_string(row.threads), row.pause > 0 ? "1 ms more" : "as here"};
    for (const auto& times : seconds) cells.push_back(show(spreadOf(times).median));
    for (const auto& counts : misses)
        cells.push_back(fmt::format("{:.0f}", spreadOf(counts).median));
    cells.push_back(fmt::format(
        "{:.2f}", missesOf(bench, played[0], {.budget = budget, .threads = row.threads}) /
                      std::max(1.0, spreadOf(misses[0]).median)));
    for (std::size_t i = 1; i < played.size(); ++i) {
        std::vector<double> ratios;
        for (std::size_t turn = 0; turn < seconds[i].size(); ++turn)
            ratios.push_back(seconds[i][turn] / seconds[0][turn]);
        cells.push_back(showRatios(ratios));
    }
    return cells;
}

void tellTimes(Report& report, CacheRendering& bench, int turns) {
    std::vector<std::string> played{"hilbert", "row", "random"};
    // Elsewhere it does not choose by the cache.
    if (bench.scene().groups) played.push_back("correlated");
    std::vector<std::string> header{"cache", "threads", "a miss costs"};
    for (const std::string& order : played) header.push_back("s " + order);
    for (const std::string& order : played) header.push_back("misses " + order);
    header.push_back("replayed over counted");
    for (std::size_t i = 1; i < played.size(); ++i)
        header.push_back(fmt::format("time {} / hilbert", played[i]));
    report.table(fmt::format("{}: rendered, seconds of the buckets by the clock, median of {} "
                             "interleaved turns; ratios with their 95 % interval",
                             bench.scene().name, turns),
                 header);
    for (const TimedRow& row : timedRows()) report.row(timed(bench, played, row, turns));
}

// Each machine renders a run of the order and has a cache of its own; nothing else is shared.
double secondsOfMachines(CacheRendering& bench, const std::vector<std::uint32_t>& cells,
                         std::size_t machines, std::uint64_t budget) {
    double most = 0;
    for (std::size_t machine = 0; machine < machines; ++machine) {
        const std::size_t begin = cells.size() * machine / machines;
        const std::size_t end = cells.size() * (machine + 1) / machines;
        const auto run = std::span(cells).subspan(begin, end - begin);
        const CacheReplay replay = replayCaches(bench.trace(), run, {.budget = budget});
        double seconds = 1e-6 * kStoreMicroseconds * static_cast<double>(replay.misses);
        for (const std::uint32_t cell : run) seconds += bench.secondsOf(cell);
        most = std::max(most, seconds);
    }
    return most;
}

void tellMachines(Report& report, CacheRendering& bench) {
    report.table(
        fmt::format("{}: machines, each with one run of the order and a cache of its own, 1 ms a "
                    "miss; replayed seconds of the slowest, and what Hilbert's order gains over "
                    "the others",
                    bench.scene().name),
        {"cache", "machines", "hilbert", "row", "random", "gain over row", "gain over random"});
    for (const std::uint64_t share : {32u, 8u, 2u, 1u}) {
        const std::uint64_t budget = bench.budgetOf(share);
        for (const std::size_t machines : {1u, 2u, 4u, 8u}) {
            std::map<std::string, double> seconds;
            for (const std::string order : {"hilbert", "row", "random"}) {
                const int seeds = order == "random" ? kRandomSeeds : 1;
                for (int seed = 1; seed <= seeds; ++seed)
                    seconds[order] +=
                        secondsOfMachines(bench,
                                          bench.cellsOf(order, static_cast<std::uint64_t>(seed)),
                                          machines, budget) /
                        seeds;
            }
            const auto gain = [&](const char* over) {
                return fmt::format("{:.0f} %", 100 * (1 - seconds["hilbert"] / seconds[over]));
            };
            report.row({fmt::format("1/{}", share), std::to_string(machines),
                        show(seconds["hilbert"]), show(seconds["row"]), show(seconds["random"]),
                        gain("row"), gain("random")});
        }
    }
}

int runProgram(int argc, char** argv) {
    std::string csvFile, docsFile, only, folder = "/tmp", plots;
    int turns = 3;
    std::int32_t side = 256;
    bool quick = false;
    CLI::App app("Bucket orders where memory is short");
    app.add_option("--csv", csvFile, "also write the tables to this CSV file");
    app.add_option("--docs", docsFile, "also put the tables into this Markdown file");
    app.add_option("--plots", plots, "a folder for plots (none)");
    app.add_option("--turns", turns, "turns of each rival (3); 0: replays alone")
        ->check(CLI::Range(0, 1000));
    app.add_option("--side", side, "pixels of a picture's side (256)")->check(CLI::Range(32, 4096));
    app.add_option("--folder", folder, "for pictures of 300 MB (/tmp)");
    app.add_flag("--quick", quick, "2 turns, 96 pixels");
    app.add_option("--only", only, "one scene")
        ->check(CLI::IsMember({"landscape", "room", "caustic"}));
    CLI11_PARSE(app, argc, argv);
    try {
        if (quick) {
            turns = 2;
            side = 96;
        }
        std::vector<std::unique_ptr<CacheRendering>> benches;
        const auto add = [&](const char* name, auto make) {
            if (only.empty() || only == name)
                benches.push_back(std::make_unique<CacheRendering>(make()));
        };
        add("landscape", [&] { return landscape(side); });
        add("room", [&] { return texturedRoom(side, folder); });
        add("caustic", [&] { return pagedCaustic(side, folder); });
        Report report("pm_bench_order_caches");
        for (const auto& bench : benches) bench->observe();
        tellUsers(report, benches);
        for (const auto& bench : benches) {
            const std::string plot =
                plots.empty() ? ""
                              : fmt::format("{}/cache_misses_{}.svg", plots, bench->scene().name);
            tellRemedies(report, *bench);
            tellMisses(report, *bench, plot);
            tellMachines(report, *bench);
            if (turns > 0) tellTimes(report, *bench, turns);
        }
        report.publish(csvFile, docsFile);
        return 0;
    } catch (const std::exception& e) {
        fmt::print(stderr, "pm_bench_order_caches: {}\n", e.what());
        return 1;
    }
}

}  // namespace
}  // namespace pm::bench

int main(int argc, char** argv) {
    return pm::bench::runProgram(argc, argv);
}
