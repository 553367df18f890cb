// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include "host_shim/cli/option_table.h"
#include "host_shim/cli/options.h"

namespace pm::host {

// What the command line of pm_host check says. Errors: kUsage.
void readCheck(const Typed& typed, CheckOptions& check);

}  // namespace pm::host
