// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <optional>

#include "host_shim/cli/options.h"
#include "host_shim/copies/copies_folder.h"
#include "host_shim/log/log.h"

namespace pm::host {

// Where the scene of the command line is the address of a packed scene (isSceneUrl): brings what of
// it is missing into the folder of copies, checks all of it, and changes the options to what a
// command line would say that names the copies; nothing else is read for the scene then. Nothing is
// done for another scene. While the answer lives nobody makes room by these copies.
// Errors: HostError kUsage for --write-sidecar; kFile where something can't be fetched or written;
// kBadInput for a manifest that is none and for contents that are not what it says; Interrupted.
std::optional<PackInUse> takeCopies(Options& options, Log& log);

}  // namespace pm::host
