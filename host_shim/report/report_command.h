// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <string>
#include <vector>

namespace pm::host {

// The arguments of a run, the program first, and what becomes of them.
using Arguments = std::vector<std::string>;

// For a shell, quoted where it would read them otherwise.
std::string shellCommand(const Arguments& arguments);

// Repeats a render that stopped by its error or by the clock: so many passes, and no target.
Arguments ofPasses(const Arguments& arguments, long long passes);

// To look at a pixel, when --only-pixel X,Y is added: writes no file and reads no checkpoint.
Arguments ofOnePixel(const Arguments& arguments);

}  // namespace pm::host
