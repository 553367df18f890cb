// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// What bucket orders, bucket sizes and the way through a bucket cost and gain.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <array>
#include <cstdio>
#include <thread>

#include "scheduler/buckets/bucket_order.h"
#include "scheduler/buckets/bucket_runner.h"
#include "scheduler/film/correlated_choice.h"
#include "tests/bench/order/idle_share.h"
#include "tests/bench/order/order_picture.h"
#include "tests/bench/order/order_run.h"
#include "tests/bench/plot/ratios.h"
#include "tests/bench/plot/report.h"
#include "tests/bench/run/bench_scenes.h"

namespace pm::bench {
namespace {

// Small, so that 20 turns of everything end; the buckets of the orders are, too, so that they are
// as many as 32 x 32 pixels make of 512 x 512.
constexpr std::int32_t kSidePixels = 256, kOrderBucketPixels = 16;
constexpr std::array kSizes{8, 16, 24, 32, 48, 64, 96, 128, 192, 256};

// figures[turn][rival] over the first rival of the same turn.
std::vector<double> ratiosOf(const std::vector<std::vector<double>>& figures, std::size_t rival) {
    std::vector<double> ratios;
    for (const auto& turn : figures) ratios.push_back(turn[rival] / turn[0]);
    return ratios;
}

// Takes turns, each beginning with another rival. measure(i): rival i's figure.
template <typename Measure>
std::vector<std::vector<double>> interleaved(int turns, std::size_t rivals, Measure measure) {
    std::vector<std::vector<double>> figures(static_cast<std::size_t>(turns));
    for (std::size_t turn = 0; turn < figures.size(); ++turn) {
        figures[turn].resize(rivals);
        for (std::size_t i = 0; i < rivals; ++i) {
            const std::size_t rival = (turn + i) % rivals;
            figures[turn][rival] = measure(rival);
        }
    }
    return figures;
}

void benchOrders(Report& report, std::vector<OrderScene>& scenes, int turns, int threads) {
    const auto orders = bucketOrders();
    std::vector<std::string> header{"scene"};
    for (const BucketOrder& order : orders.subspan(1)) header.emplace_back(order.name);
    header.emplace_back("choosing, share of the time (correlated)");
    report.table(
        fmt::format("Processor time of the buckets by order, over Hilbert's: mean of {} "
                    "interleaved turns and its 95 % interval; {} threads, {} x {} buckets of {}",
                    turns, threads, kSidePixels / kOrderBucketPixels,
                    kSidePixels / kOrderBucketPixels, kOrderBucketPixels),
        header);
    for (OrderScene& scene : scenes) {
        double choice = 0, all = 0;
        const auto figures = interleaved(turns, orders.size(), [&](std::size_t rival) {
            const BucketTimes times =
                scene.render({std::string(orders[rival].name), kOrderBucketPixels, threads});
            if (orders[rival].isCorrelated) {
                choice += times.choiceSeconds;
                all += times.processorSeconds;
            }
            return times.processorSeconds;
        });
        std::vector<std::string> row{scene.name()};
        for (std::size_t i = 1; i < orders.size(); ++i)
            row.push_back(showRatios(ratiosOf(figures, i)));
        row.push_back(fmt::format("{:.4f} %", 100 * choice / all));
        report.row(row);
    }
}

void benchSizes(Report& report, std::vector<OrderScene>& scenes, int turns, int threads) {
    for (OrderScene& scene : scenes) {
        report.table(
            fmt::format("Bucket size, {}, {} x {} pixels: over that of 32, mean of {} "
                        "interleaved turns and its 95 % interval; {} threads; idle: share of the "
                        "threads' time at the end of a pass, measured, and computed from the "
                        "atoms' times for more threads, where atoms are shared / where they are "
                        "not",
                        scene.name(), kSidePixels, kSidePixels, turns, threads),
            {"size", "processor time", "elapsed time", "idle", "idle, 16 threads",
             "idle, 64 threads"});
        std::vector<std::int32_t> sizes{32};
        for (const std::int32_t size : kSizes)
            if (size != 32) sizes.push_back(size);
        std::vector<std::vector<double>> seconds(static_cast<std::size_t>(turns));
        std::vector<BucketTimes> last(sizes.size());
        std::vector<std::vector<double>> idle(sizes.size());
        for (auto& turn : seconds) turn.resize(sizes.size());
        std::vector<int> taken(sizes.size());
        const auto processor = interleaved(turns, sizes.size(), [&](std::size_t i) {
            last[i] = scene.render({"hilbert", sizes[i], threads});
            seconds[static_cast<std::size_t>(taken[i]++)][i] = last[i].seconds;
            idle[i].push_back(last[i].idleSeconds / (last[i].seconds * threads));
            return last[i].processorSeconds;
        });
        const auto modelled = [&](std::size_t i, int workers) {
            return fmt::format("{:.1f} % / {:.1f} %", 100 * idleShare(last[i].atoms, workers, true),
                               100 * idleShare(last[i].atoms, workers, false));
        };
        for (const std::int32_t size : kSizes) {
            const auto i = static_cast<std::size_t>(std::find(sizes.begin(), sizes.end(), size) -
                                                    sizes.begin());
            report.row({std::to_string(size), showRatios(ratiosOf(processor, i)),
                        showRatios(ratiosOf(seconds, i)),
                        fmt::format("{:.2f} %", 100 * spreadOf(idle[i]).median), modelled(i, 16),
                        modelled(i, 64)});
        }
    }
}

void benchInside(Report& report, std::vector<OrderScene>& scenes, int turns, int) {
    using Inside = OrderScene::Inside;
    constexpr std::array kWays{
        std::pair{Inside::kAtomsInRows, "atoms in rows (as it is)"},
        std::pair{Inside::kBucketRows, "rows of the bucket"},
        std::pair{Inside::kAtomsOnCurve, "atoms on a Hilbert curve"},
        std::pair{Inside::kPixelAtomRows, "pixel by pixel: atoms in rows"},
        std::pair{Inside::kPixelRows, "pixel by pixel: rows of the bucket"},
        std::pair{Inside::kPixelsOnCurve, "pixel by pixel: a Hilbert curve"},
    };
    report.table(
        fmt::format("Way through a bucket's pixels, one thread: processor time over that of atoms "
                    "in rows, mean of {} interleaved turns and its 95 % interval. Pixel by pixel, "
                    "each pixel is a call of its own: compare those with each other",
                    turns),
        {"way", scenes[0].name(), scenes[1].name()});
    std::vector<std::vector<std::string>> rows;
    for (const auto& way : kWays) rows.push_back({way.second});
    for (OrderScene& scene : scenes) {
        const auto figures = interleaved(
            turns, kWays.size(), [&](std::size_t i) { return scene.renderInside(kWays[i].first); });
        auto byPixel = figures;
        for (auto& turn : byPixel) turn[0] = turn[3];
        for (std::size_t i = 0; i < kWays.size(); ++i)
            rows[i].push_back(showRatios(ratiosOf(i < 3 ? figures : byPixel, i)));
    }
    for (auto& row : rows) report.row(row);
}

// Nothing is rendered: what drawing, handing out and delivering cost, and the order itself.
void benchAdministration(Report& report, std::vector<OrderScene>&, int turns, int) {
    report.table(
        "Administration, one thread, 8192 x 4096 pixels in buckets of 32 with 4 floats a "
        "pixel: microseconds a bucket, median and quartiles",
        {"order", "making the order", "drawing and delivering (16 atoms), nothing rendered",
         "the same with choosing"});
    const BucketGrid grid({0, 0, 8192, 4096}, 32);
    const double scale = 1e6 / grid.cellCount();
    WorkerArena arena(1);
    for (const BucketOrder& order : bucketOrders()) {
        std::vector<std::uint32_t> cells;
        const auto run = [&](bool chooses) {
            CorrelatedChoice choice(grid, cells, 1);
            BucketWork work;
            work.floatsPerPixel = 4;
            work.render = [](std::uint32_t, const Rect&, const Rect&, int, std::span<float>) {};
            work.deliver = [&](const RenderedBucket& bucket) {
                if (chooses) choice.finished(bucket.cell, bucket.pixels, 4, 0);
            };
            if (chooses) work.choose = [&](int worker) { return choice.next(worker); };
            runBuckets(arena, grid, cells, CancelToken(), work);
        };
        const auto times =
            takeTurns(turns, {[&] { cells = order.cells(grid.columns(), grid.rows(), 1); },
                              [&] { run(false); }, [&] { run(order.isCorrelated); }});
        report.row({std::string(order.name), show(spreadOf(times[0]), scale),
                    show(spreadOf(times[1]), scale),
                    order.isCorrelated ? show(spreadOf(times[2]), scale) : ""});
    }
}

std::vector<OrderScene> makeScenes() {
    std::vector<OrderScene> scenes;
    scenes.reserve(2);
    for (const auto& [name, maker] : {std::pair{"box with 2 spheres", boxWithSpheres()},
                                      std::pair{"room with 1 M triangles", roomWithMesh()}}) {
        RenderSettings settings =
            test::smallFrame(kSidePixels, kSidePixels, IntegratorKind::kPhoton, 4, 2);
        settings.photons = 30'000;
        scenes.emplace_back(name, maker.build(), settings);
    }
    return scenes;
}

int runProgram(int argc, char** argv) {
    using Part = void (*)(Report&, std::vector<OrderScene>&, int, int);
    static const std::map<std::string, Part> kParts = {{"1-administration", benchAdministration},
                                                       {"2-orders", benchOrders},
                                                       {"3-inside", benchInside},
                                                       {"4-sizes", benchSizes}};
    std::string csvFile, docsFile, only, picture;
    int turns = 20, threads = static_cast<int>(std::thread::hardware_concurrency());
    bool quick = false;
    CLI::App app("Bucket orders and sizes");
    app.add_option("--csv", csvFile, "also write the tables to this CSV file");
    app.add_option("--docs", docsFile, "also put the tables into this Markdown file");
    app.add_option("--picture", picture, "only draw the orders on 21 x 13 buckets into this SVG");
    app.add_option("--turns", turns, "turns of each rival (20)")->check(CLI::Range(2, 1000));
    app.add_option("--threads", threads, "threads (all)")->check(CLI::Range(1, 1024));
    app.add_flag("--quick", quick, "3 turns");
    app.add_option("--only", only, "one part: administration, orders, inside or sizes")
        ->check(CLI::IsMember({"administration", "orders", "inside", "sizes"}));
    CLI11_PARSE(app, argc, argv);
    try {
        if (!picture.empty()) {
            drawOrders(picture, 21, 13);
            return 0;
        }
        if (quick) turns = 3;
        std::vector<OrderScene> scenes = makeScenes();
        Report report("pm_bench_orders");
        for (const auto& [name, part] : kParts)
            if (only.empty() || name.ends_with(only)) part(report, scenes, turns, threads);
        report.publish(csvFile, docsFile);
        return 0;
    } catch (const std::exception& e) {
        fmt::print(stderr, "pm_bench_orders: {}\n", e.what());
        return 1;
    }
}

}  // namespace
}  // namespace pm::bench

int main(int argc, char** argv) {
    return pm::bench::runProgram(argc, argv);
}
