// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// The paper's first experiment (section 6, Fig. 9), measured: scenes x bucket orders x workers.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "tests/bench/paper/paper_scenes.h"

namespace pm::bench {

constexpr int kPaperWorkers = 8;
// The paper's three, and the one that chooses while it renders.
constexpr std::array<const char*, 4> kPaperOrders = {"hilbert", "row", "random", "correlated"};

// Seconds of one pass of one order in one turn: photons, maps and buckets.
struct OrderSeconds {
    std::array<double, kPaperWorkers> replayed{};  // of 1, 2, ... workers, from processor seconds
    double wholeBuckets = 0;       // replayed, 8 workers that don't share a bucket's atoms
    std::vector<double> measured;  // of 1, 2, ... workers, by the clock
};
using OrdersTurn = std::array<OrderSeconds, kPaperOrders.size()>;

struct SceneOrders {
    std::string name;
    double serialShare = 0;  // of photons and maps, by the clock
    std::vector<OrdersTurn> turns;
    // Replayed over measured seconds of the buckets alone: for 1, 2, ... workers, the mean over
    // orders of each turn.
    std::vector<std::vector<double>> check;
};

struct PaperOrdersOptions {
    int turns = 8;             // of each order and number of workers, interleaved
    int workers = 2;           // measured from 1 to so many
    double bucketSeconds = 0;  // that the replay adds to each bucket, as a network would
};

// Threads: one call at a time, so that the seconds are its own.
SceneOrders runPaperOrders(const PaperScene& scene, const PaperOrdersOptions& options);

}  // namespace pm::bench
