// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include "tests/bench/plot/report.h"
#include "tests/bench/run/ladder.h"

namespace pm::bench {

// Begins the table of what the plan earns: each scene rendered by the plan's own choice and with
// everything forced on. Says in one line when the library has no such setting; then false.
bool beginPlanTable(const PluginHost& host, Report& report);

// One row: processor seconds of both, and how far the means differ, from renders of several seeds.
void addPlanRow(const PluginHost& host, const NeutralScene& scene, const Yardstick& yardstick,
                const LadderRequest& request, Report& report);

}  // namespace pm::bench
