// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <chrono>
#include <string>
#include <vector>

#include "host_shim/farm/engines/engine.h"

namespace pm::host {

// No machine is waited for longer; it may be alive and yet start nothing.
inline constexpr std::chrono::seconds kToAnswer{20};

// A shell's command that prints a line about the machine it runs on, and what such lines say; other
// lines are left out.
const std::string& machineQuestion();
std::vector<FarmMachine> machineAnswers(const std::string& lines);

}  // namespace pm::host
