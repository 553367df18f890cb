// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include "host_shim/cli/options.h"
#include "host_shim/log/log.h"

namespace pm::host {

// pm_host check: renders a suite and holds it against its references, or makes those; results go to
// standard output. Returns the exit code: 0, 6 when anything differs, 3 when a reference is
// missing.
int runCheckCommand(const CheckOptions& options);

}  // namespace pm::host
