// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include "host_shim/cli/option_table.h"
#include "host_shim/cli/options.h"

namespace pm::host {

// What the command line says of scenes that are packed and fetched. Errors of all: kUsage.

// Where copies are kept and how much they may take.
void readCopies(const Typed& typed, Options& options);

// pm_host pack has a scene that is a file, and one output, a folder.
void checkPack(const Options& options);

}  // namespace pm::host
