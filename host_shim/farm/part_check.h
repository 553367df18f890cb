// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstddef>
#include <filesystem>
#include <set>

#include "host_shim/farm/job/farm_plan.h"
#include "host_shim/log/log.h"

namespace pm::host {

// Reads the parts of a frame that are there and returns the numbers of its runs that have no whole
// one, after removing those that are damaged. Errors: kBadInput where one is of another picture.
std::set<int> runsWithoutPart(const FarmPlan& plan, std::size_t frame,
                              const std::filesystem::path& plugin, Log& log);

}  // namespace pm::host
