// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <filesystem>

#include "tests/bench/farm/farm_costs.h"
#include "tests/bench/plot/report.h"

namespace pm::bench {

// What was measured of each frame.
void tellCosts(const MeasuredFarm& farm, Report& report);
// Farms on Slurm beside their replays; a line where there are none.
void tellReal(const MeasuredFarm& farm, Report& report);
// Efficiency of 1 to 1,024 workers, photons once and on each, an hour's and a longer frame.
void tellScale(const MeasuredFarm& farm, Report& report);
// The same by kinds of network, runs for each worker, and with slow workers.
void tellNetworks(const MeasuredFarm& farm, Report& report);
// The paper's 1 to 8 computers.
void tellPaper(const MeasuredFarm& farm, Report& report);
// What preemption costs, replayed and measured.
void tellFaults(const MeasuredFarm& farm, Report& report);
// Draws what tellScale() tells.
void plotScale(const MeasuredFarm& farm, const std::filesystem::path& file);

}  // namespace pm::bench
