// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// The paper's first experiment, told: tables, plot and file of what runPaperOrders() found, beside
// what the paper says.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tests/bench/paper/paper_orders.h"
#include "tests/bench/plot/ratios.h"
#include "tests/bench/plot/report.h"

namespace pm::bench {

// Whether a saving that the paper states is found: "yes", "yes, more", "less", "no" (the interval
// holds 0) or "the other way round". stated, saved: shares of the time; stated 0 = any at all.
std::string verdictOn(double stated, const Interval& saved);

// All tables of Fig. 9. At least one scene.
void reportPaperOrders(Report& report, const std::vector<SceneOrders>& scenes);

// paper_orders.csv and images/paper_orders.svg in this folder; bars are the clock's where the
// replay agrees with it to a quarter, else the replay's. Throws Error(kIo).
void writePaperOrders(const std::filesystem::path& folder, const std::vector<SceneOrders>& scenes);

}  // namespace pm::bench
