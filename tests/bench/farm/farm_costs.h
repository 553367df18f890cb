// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// What measure_farm.py wrote.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "tests/bench/farm/farm_replay.h"

namespace pm::bench {

struct MeasuredFrame {
    std::string name, size;
    int passes = 0;
    FarmCosts costs;
    // The same frame with so many passes that a render without a farm takes so long.
    FarmCosts lastingFor(double seconds) const;
};

// A farm on Slurm that was timed; seconds.
struct RealFarm {
    int workers = 1, runs = 1;
    double seconds = 0, runSeconds = 0;
    double others = 0;  // processors that other programs kept busy meanwhile
};

struct MeasuredFarm {
    int cores = 1;
    double sharedSpeed = 1;
    std::vector<MeasuredFrame> frames;
    // Only where Slurm is installed.
    FarmRules latencies;  // what is known of them by measuring
    std::optional<MeasuredFrame> realFrame;
    std::vector<RealFarm> realFarms;
    double preemptedEvery = 0;  // processor seconds
    int preemptedStarts = 0;
    double preemptedSeconds = 0, wholeSeconds = 0;
};

// Errors: Error(kIo) for a file that can't be read or is no such thing.
MeasuredFarm readMeasuredFarm(const std::filesystem::path& file);

}  // namespace pm::bench
