// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "tests/bench/paper/paper_claims.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include "integrator/values/error.h"
#include "tests/bench/plot/bar_plot.h"
#include "tests/bench/run/timing.h"

namespace pm::bench {

namespace {

constexpr std::size_t kHilbert = 0, kRow = 1, kRandom = 2, kMost = kPaperWorkers - 1;

// One figure of each turn.
template <typename Figure>
std::vector<double> ofTurns(const SceneOrders& scene, Figure figure) {
    std::vector<double> figures;
    for (const OrdersTurn& turn : scene.turns) figures.push_back(figure(turn));
    return figures;
}

double replayedMedian(const SceneOrders& scene, std::size_t order, std::size_t k) {
    return spreadOf(ofTurns(scene, [&](const OrdersTurn& turn) { return turn[order].replayed[k]; }))
        .median;
}

double measuredMedian(const SceneOrders& scene, std::size_t order, std::size_t k) {
    return spreadOf(ofTurns(scene, [&](const OrdersTurn& turn) { return turn[order].measured[k]; }))
        .median;
}

// Time that Hilbert's order takes over that of another, turn by turn.
std::vector<double> hilbertOver(const SceneOrders& scene, std::size_t order, std::size_t k) {
    return ofTurns(scene, [&](const OrdersTurn& turn) {
        return turn[kHilbert].replayed[k] / turn[order].replayed[k];
    });
}

Interval savedBy(const std::vector<double>& ratios) {
    const Interval ratio = intervalOf(ratios);
    return {1 - ratio.mean, 1 - ratio.high, 1 - ratio.low};
}

std::string percent(const Interval& share) {
    return fmt::format("{:.1f} % ({:.1f} to {:.1f})", 100 * share.mean, 100 * share.low,
                       100 * share.high);
}

// From one worker to 2, 4 and 8: the mean ratio of a doubling, of each turn of each scene.
Interval savedByDoubling(const std::vector<SceneOrders>& scenes, std::size_t order) {
    std::vector<double> ratios;
    for (const SceneOrders& scene : scenes)
        for (const double ratio : ofTurns(scene, [&](const OrdersTurn& turn) {
                 return std::cbrt(turn[order].replayed[kMost] / turn[order].replayed[0]);
             }))
            ratios.push_back(ratio);
    return savedBy(ratios);
}

// Whether other programs left the clock's seconds of so many workers worth a bar.
bool isClockRight(const SceneOrders& scene, std::size_t k) {
    if (k >= scene.check.size()) return false;
    const double ratio = intervalOf(scene.check[k]).mean;
    return ratio > 0.8 && ratio < 1.25;
}

void tableOfSeconds(Report& report, const std::vector<SceneOrders>& scenes) {
    const std::size_t measured = scenes[0].turns[0][0].measured.size();
    std::vector<std::string> header{"scene, order"};
    for (std::size_t k = 1; k <= measured; ++k) header.push_back(fmt::format("{} by the clock", k));
    for (int k = 1; k <= kPaperWorkers; ++k) header.push_back(fmt::format("{} replayed", k));
    header.emplace_back("8 replayed, whole buckets");
    report.table(
        fmt::format(
            "Fig. 9. Seconds of one pass (photons, maps, buckets) by number of workers, "
            "median of {} interleaved turns. \"By the clock\" is elapsed time; \"replayed\" "
            "is a discrete-event replay of the processor seconds that one worker took for "
            "each 8 x 8 pixels, and no measurement",
            scenes[0].turns.size()),
        header);
    for (const SceneOrders& scene : scenes)
        for (std::size_t order = 0; order < kPaperOrders.size(); ++order) {
            std::vector<std::string> row{fmt::format("{}, {}", scene.name, kPaperOrders[order])};
            for (std::size_t k = 0; k < measured; ++k)
                row.push_back(show(measuredMedian(scene, order, k)));
            for (std::size_t k = 0; k < kPaperWorkers; ++k)
                row.push_back(show(replayedMedian(scene, order, k)));
            row.push_back(show(spreadOf(ofTurns(scene, [&](const OrdersTurn& turn) {
                                   return turn[order].wholeBuckets;
                               })).median));
            report.row(row);
        }
}

void tableOfCheck(Report& report, const std::vector<SceneOrders>& scenes) {
    std::vector<std::string> header{"scene"};
    for (std::size_t k = 1; k <= scenes[0].check.size(); ++k)
        header.push_back(fmt::format("{} worker{}", k, k == 1 ? "" : "s"));
    header.emplace_back("serial share of photons and maps");
    report.table(
        "The replay held against the clock where there are so many processors: replayed over "
        "elapsed seconds of the buckets, mean over orders of each turn, then of the turns with its "
        "95 % interval; 1 is right, and less where other programs took processor time",
        header);
    for (const SceneOrders& scene : scenes) {
        std::vector<std::string> row{scene.name};
        for (const auto& ratios : scene.check) row.push_back(showRatios(ratios));
        row.push_back(fmt::format("{:.0f} %", 100 * scene.serialShare));
        report.row(row);
    }
}

void tableOfOrders(Report& report, const std::vector<SceneOrders>& scenes) {
    report.table(
        "Time over that of Hilbert's order, replayed from processor seconds: mean of the "
        "turns and its 95 % interval",
        {"scene", "row, 1 worker", "random, 1", "correlated, 1", "row, 8 workers", "random, 8",
         "correlated, 8"});
    for (const SceneOrders& scene : scenes) {
        std::vector<std::string> row{scene.name};
        for (const std::size_t k : {std::size_t{0}, kMost})
            for (std::size_t order = 1; order < kPaperOrders.size(); ++order) {
                std::vector<double> ratios = hilbertOver(scene, order, k);
                for (double& ratio : ratios) ratio = 1 / ratio;
                row.push_back(showRatios(ratios));
            }
        report.row(row);
    }
}

void tableOfClaims(Report& report, const std::vector<SceneOrders>& scenes) {
    report.table(
        "What the paper says, and what is found here. Savings are shares of the time: "
        "its \"performance increase\" of 85 % from one computer to eight can be no other, "
        "since eight can save 87.5 % at most. \"No\" where the interval holds 0; \"less\" "
        "and \"more\" where it lies beside the paper's figure",
        {"statement", "paper", "here", "holds?"});
    const auto claim = [&](const std::string& what, double stated, const Interval& saved) {
        report.row({what, fmt::format("{:.0f} %", 100 * stated), percent(saved),
                    verdictOn(stated, saved)});
    };
    for (const SceneOrders& scene : scenes) {
        const bool isTheirs = &scene == &scenes.front();
        for (const auto& [order, stated] : {std::pair{kRandom, 0.67}, std::pair{kRow, 0.41}}) {
            const Interval saved = savedBy(hilbertOver(scene, order, kMost));
            const std::string what = fmt::format("Hilbert's order saves over {}, {}, 8 workers",
                                                 kPaperOrders[order], scene.name);
            if (isTheirs)
                claim(what, stated, saved);
            else  // the text has figures of its first scene only: there is a gain
                report.row({what, "some", percent(saved), verdictOn(0, saved)});
        }
    }
    claim("twice the workers save, random", 0.25, savedByDoubling(scenes, kRandom));
    claim("twice the workers save, hilbert", 0.37, savedByDoubling(scenes, kHilbert));
    claim("twice the workers save, row", 0.37, savedByDoubling(scenes, kRow));
    const SceneOrders& last = scenes.back();
    claim(fmt::format("eight workers save over one, {}, hilbert", last.name), 0.85,
          savedBy(ofTurns(last, [](const OrdersTurn& turn) {
              return turn[kHilbert].replayed[kMost] / turn[kHilbert].replayed[0];
          })));
}

}  // namespace

std::string verdictOn(double stated, const Interval& saved) {
    if (saved.high < 0) return "the other way round";
    if (saved.low <= 0) return "no";
    if (stated > 0 && saved.low > stated) return "yes, more";
    return saved.high >= stated ? "yes" : "less";
}

void reportPaperOrders(Report& report, const std::vector<SceneOrders>& scenes) {
    tableOfSeconds(report, scenes);
    tableOfCheck(report, scenes);
    tableOfOrders(report, scenes);
    tableOfClaims(report, scenes);
}

void writePaperOrders(const std::filesystem::path& folder, const std::vector<SceneOrders>& scenes) {
    const auto file = folder / "paper_orders.csv";
    std::ofstream csv(file);
    csv << "scene,order,workers,kind,turn,seconds\n";
    BarPlot plot{{kPaperOrders.begin(), kPaperOrders.end()}, {}, "pale: replayed"};
    for (const SceneOrders& scene : scenes) {
        BarPanel panel{scene.name, "seconds a pass", {}, {}};
        for (std::size_t k = 1; k <= kPaperWorkers; ++k)
            panel.groups.push_back(fmt::format("{} worker{}", k, k == 1 ? "" : "s"));
        for (std::size_t order = 0; order < kPaperOrders.size(); ++order) {
            auto& bars = panel.bars.emplace_back();
            const std::size_t measured = scene.turns[0][order].measured.size();
            for (std::size_t k = 0; k < kPaperWorkers; ++k)
                bars.push_back(isClockRight(scene, k) ? Bar{measuredMedian(scene, order, k), false}
                                                      : Bar{replayedMedian(scene, order, k), true});
            for (std::size_t turn = 0; turn < scene.turns.size(); ++turn) {
                const OrderSeconds& seconds = scene.turns[turn][order];
                const auto line = [&](std::size_t k, const char* kind, double value) {
                    csv << fmt::format("{},{},{},{},{},{:.6g}\n", scene.name, kPaperOrders[order],
                                       k, kind, turn + 1, value);
                };
                for (std::size_t k = 0; k < measured; ++k)
                    line(k + 1, "clock", seconds.measured[k]);
                for (std::size_t k = 0; k < kPaperWorkers; ++k)
                    line(k + 1, "replayed", seconds.replayed[k]);
                line(kPaperWorkers, "replayed whole buckets", seconds.wholeBuckets);
            }
        }
        plot.panels.push_back(std::move(panel));
    }
    if (!csv.flush()) throw Error(Status::kIo, file.string() + ": can't be written");
    writeSvg(folder / "images" / "paper_orders.svg", plot);
}

}  // namespace pm::bench
