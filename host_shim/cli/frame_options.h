// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "host_shim/cli/options.h"

namespace pm::host {

// A command line with --frames as one for each frame, with --frame; one without is itself alone.
// Errors: kUsage, also where two frames would write the same file.
std::vector<Options> perFrame(const Options& options);

// A frame of a shot whose first has found that error scale, stops: one scale for all, or errors and
// samples would jump where the light changes. Its command line says it, so that it repeats the
// frame. The same frame where there is none, where it was told one, and of a merge.
Options ofErrorScale(Options frame, std::optional<std::int32_t> stops);
bool tellsErrorScale(const Options& options);

// Whether two of these frames are one render whose files have other names: the number of a frame is
// neither in what is read nor in a setting.
bool areSameRender(const Options& frame, const Options& other);

}  // namespace pm::host
