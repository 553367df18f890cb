// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "tests/bench/paper/paper_orders.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <numeric>

#include "tests/bench/order/bucket_replay.h"
#include "tests/bench/order/order_run.h"
#include "tests/bench/plot/ratios.h"
#include "tests/bench/run/bench_scenes.h"
#include "tests/bench/run/timing.h"

namespace pm::bench {

namespace {

constexpr std::int32_t kBucketPixels = 32;  // as the paper's (section 5.2)
constexpr std::uint32_t kLevel = 3;         // 4 samples a pixel in a pass

// What the replay goes by: all of it taken from a run with one worker, but for the serial share.
struct Costs {
    PartlySerial prepare;  // photons and maps
    std::vector<std::vector<double>> atoms;
    double bucketSeconds = 0;

    double buckets(int workers, bool sharesAtoms = true) const {
        return replayBuckets(atoms, {workers, sharesAtoms, bucketSeconds}).seconds;
    }
};

Costs costsOf(const BucketTimes& alone, double serialShare) {
    double atoms = 0;
    for (const auto& bucket : alone.atoms)
        atoms = std::accumulate(bucket.begin(), bucket.end(), atoms);
    const auto buckets = static_cast<double>(alone.atoms.size());
    const double administration = std::max(0.0, alone.processorSeconds - atoms) / buckets;
    return {{alone.prepareProcessorSeconds, serialShare}, alone.atoms, administration};
}

// [turn][order][workers - 1]. In each turn everything once, each beginning with another rival.
using Times = std::vector<std::vector<std::vector<BucketTimes>>>;

Times measure(const PaperScene& scene, const PaperOrdersOptions& options) {
    const std::int32_t side = scene.scene.size;
    OrderScene renderer(scene.name, makeNeutralScene(scene.scene).build(),
                        test::smallFrame(side, side, IntegratorKind::kPhoton, 4, kLevel));
    const auto workers = static_cast<std::size_t>(options.workers);
    const std::size_t orders = kPaperOrders.size(), rivals = orders * workers;
    renderer.render({"hilbert", kBucketPixels, options.workers});  // warms up
    Times times(static_cast<std::size_t>(options.turns),
                std::vector(orders, std::vector<BucketTimes>(workers)));
    for (std::size_t turn = 0; turn < times.size(); ++turn) {
        for (std::size_t i = 0; i < rivals; ++i) {
            const std::size_t rival = (turn + i) % rivals;
            const std::size_t order = rival % orders, k = rival / orders;
            times[turn][order][k] =
                renderer.render({kPaperOrders[order], kBucketPixels, static_cast<int>(k + 1)});
        }
        fmt::print(stderr, "  {}: turn {} of {}\n", scene.name, turn + 1, times.size());
    }
    return times;
}

// How much of photons and maps does not spread over the workers there are: median of all runs.
double serialShareIn(const Times& times, int workers) {
    std::vector<double> shares;
    for (const auto& turn : times)
        for (const auto& runs : turn)
            shares.push_back(
                serialShareOf(runs.front().prepareSeconds / runs.back().prepareSeconds, workers));
    return spreadOf(shares).median;
}

OrderSeconds secondsOfOrder(const std::vector<BucketTimes>& runs, Costs costs,
                            double bucketSeconds) {
    OrderSeconds result;
    for (const BucketTimes& run : runs) result.measured.push_back(run.prepareSeconds + run.seconds);
    costs.bucketSeconds += bucketSeconds;
    for (int k = 1; k <= kPaperWorkers; ++k)
        result.replayed[static_cast<std::size_t>(k - 1)] = costs.prepare.with(k) + costs.buckets(k);
    result.wholeBuckets = costs.prepare.with(kPaperWorkers) + costs.buckets(kPaperWorkers, false);
    return result;
}

}  // namespace

SceneOrders runPaperOrders(const PaperScene& scene, const PaperOrdersOptions& options) {
    const Times times = measure(scene, options);
    SceneOrders result{scene.name, serialShareIn(times, options.workers), {}, {}};
    result.check.resize(static_cast<std::size_t>(options.workers));
    for (const auto& turn : times) {
        OrdersTurn& seconds = result.turns.emplace_back();
        std::vector<std::vector<double>> ratios(result.check.size());
        for (std::size_t order = 0; order < turn.size(); ++order) {
            const Costs costs = costsOf(turn[order].front(), result.serialShare);
            seconds[order] = secondsOfOrder(turn[order], costs, options.bucketSeconds);
            for (std::size_t k = 0; k < ratios.size(); ++k)
                ratios[k].push_back(costs.buckets(static_cast<int>(k + 1)) /
                                    turn[order][k].seconds);
        }
        for (std::size_t k = 0; k < ratios.size(); ++k)
            result.check[k].push_back(intervalOf(ratios[k]).mean);
    }
    return result;
}

}  // namespace pm::bench
