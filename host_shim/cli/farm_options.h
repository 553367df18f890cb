// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <vector>

#include "host_shim/cli/option_table.h"
#include "host_shim/cli/options.h"

namespace pm::host {

// All options that were typed, by their longest names, in the order of the help.
std::vector<GivenOption> givenOptions(const CLI::App& app);

// --frames; its first frame is taken as if --frame said so. Errors: kUsage for another text than a
// sequence, and where --frame is there as well.
void readFrames(Typed& typed, Options& options);

// What is typed of the farm itself, and what a farm forbids: all that is of one process, ends a
// render early, or makes no picture. Errors: kUsage.
void readFarm(const Typed& typed, Options& options);

}  // namespace pm::host
