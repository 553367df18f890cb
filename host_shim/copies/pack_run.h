// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include "host_shim/cli/options.h"
#include "host_shim/log/log.h"

namespace pm::host {

// pm_host pack SCENE [options of a render] -o FOLDER: all files that the command line reads for its
// scene (its own, libraries, textures, sidecar, --environment, the colour config with what it
// names), as a folder that any static server can offer. Contents that are there already are not
// written again; the manifest comes last. Returns the exit code. Errors: those of reading the
// scene; HostError kFile; kBadInput for files that have no place in a pack (PackPlaces,
// filesOfConfig); Interrupted.
int runPack(const Options& options, Log& log);

}  // namespace pm::host
