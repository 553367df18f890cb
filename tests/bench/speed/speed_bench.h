// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include "tests/bench/plot/report.h"

namespace pm::bench {

// The parts of pm_bench_speed; each adds its tables. turns: how often each rival is timed.
void benchRays(Report& report, int turns);
void benchPhotons(Report& report, int turns);
void benchQueries(Report& report, int turns);
void benchPhases(Report& report, int turns);
void benchSampler(Report& report, int turns);
void benchSplit(Report& report, int turns);

}  // namespace pm::bench
