// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <string>

#include "host_shim/farm/job/farm_plan.h"
#include "host_shim/farm/job/job_folder.h"

namespace pm::host {

// A page to look at: which machine made what and when, by what run.sh has noted, and the tasks with
// what was predicted of them. Files that aren't there are tasks that haven't begun.
std::string farmPage(const FarmPlan& plan, const JobFolder& folder);

}  // namespace pm::host
