// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <vector>

#include "host_shim/cli/options.h"
#include "host_shim/farm/engines/engine.h"
#include "host_shim/farm/job/farm_plan.h"
#include "host_shim/farm/job/job_folder.h"
#include "host_shim/log/log.h"

namespace pm::host {

// Decides what a farm does: renders a small picture of the first frame for costs, cuts runs of
// about the same cost and pins the instruction set. What the plan is compared by (given) is left to
// the caller. frames: the command line for each frame, one at least. machines: none where they are
// not known. Errors: those of the small render.
FarmPlan planFarm(const std::vector<Options>& frames, const JobFolder& folder,
                  const std::vector<FarmMachine>& machines, Log& log);

// Whether a plan that is there is of this command line. Errors: kUsage where it isn't, with the
// option that differs.
void checkPlanFits(const FarmPlan& plan, const FarmOptions& farm, const JobFolder& folder);

}  // namespace pm::host
