// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <filesystem>
#include <string>

#include "host_shim/farm/job/job_folder.h"

namespace pm::host {

// The batch script of the arrays, in the job's folder: an element makes one task.
std::filesystem::path slurmScript(const JobFolder& folder);
std::string slurmScriptText(const JobFolder& folder);

}  // namespace pm::host
