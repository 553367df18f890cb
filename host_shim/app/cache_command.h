// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include "host_shim/cli/options.h"

namespace pm::host {

// pm_host cache: lists, checks or empties the folder of prepared textures; results go to standard
// output. Returns the exit code.
int runCacheCommand(const Options& options);

}  // namespace pm::host
