// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <string>

#include "host_shim/farm/engines/engine.h"
#include "host_shim/farm/job/farm_plan.h"
#include "host_shim/farm/job/job_folder.h"

namespace pm::host {

// For --dry-run: the tasks with their predicted costs, and what the engine (null for commands)
// would call.
std::string farmPreview(const FarmPlan& plan, const JobFolder& folder, const Engine* engine);

// For any farm manager: a command a line, in stages; each stage begins when all of the one before
// have ended with 0. Lines that begin with # say which stage it is.
std::string farmCommands(const FarmPlan& plan, const JobFolder& folder);

}  // namespace pm::host
