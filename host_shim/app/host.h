// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <string>
#include <vector>

namespace pm::host {

// The whole of pm_host, for main: sets up the process (variables, signals, closed descriptors),
// runs and returns the exit code. Once in a process.
int runProcess(int argc, char** argv);

// The whole of pm_host but for what it does to its process: reads the command line (without the
// program's name), renders, writes, and returns the exit code. No exception leaves it; what went
// wrong is said in one line on standard error.
int runHost(const std::vector<std::string>& arguments);

}  // namespace pm::host
