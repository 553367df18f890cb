// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <vector>

#include "host_shim/cli/options.h"

namespace pm::host {

// A command line with --frames as one for each frame, with --frame; one without is itself alone.
// Errors: kUsage, also where two frames would write the same file.
std::vector<Options> perFrame(const Options& options);

// Whether two of these frames are one render whose files have other names: the number of a frame is
// neither in what is read nor in a setting.
bool areSameRender(const Options& frame, const Options& other);

}  // namespace pm::host
