// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <string>

#include "host_shim/farm/job/farm_plan.h"

namespace pm::host {

// tasks.txt: the command of each task, one a line, for a shell.
std::string taskLines(const FarmPlan& plan);

// run.sh, which makes one task, as `sh run.sh NUMBER [more options]`: all engines and any farm
// manager start the same. It notes start and end with the machine's name, keeps a checkpoint unless
// the same task runs elsewhere at that moment, and ends with pm_host's exit code.
std::string runScriptText(const FarmPlan& plan);

}  // namespace pm::host
