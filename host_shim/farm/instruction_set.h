// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <string>
#include <vector>

#include "host_shim/farm/engines/engine.h"

namespace pm::host {

// The name that --isa takes of the best instruction set that a processor with these flags (of
// /proc/cpuinfo) has.
std::string instructionSetOf(const std::string& cpuFlags);

// The best one that all have: own, and those of machines whose flags are known.
std::string commonInstructionSet(const std::string& own, const std::vector<FarmMachine>& machines);

}  // namespace pm::host
