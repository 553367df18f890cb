// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include "host_shim/cli/option_table.h"
#include "host_shim/cli/option_values.h"
#include "host_shim/cli/options.h"

namespace pm::host {

// What the command line of pm_host watch says beside that of a merge. Errors: kUsage.
void readWatch(const Typed& typed, const FrameNumber& frame, Options& options);

}  // namespace pm::host
