// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include "host_shim/cli/options.h"
#include "host_shim/log/log.h"

namespace pm::host {

// pm_host SCENE, which may be the address of a packed scene. Returns the exit code. Errors: those
// of takeCopies.
int runScene(Options options, Log& log);

// pm_host SCENE --frames A-B: renders one frame after the other; of those that are the same render
// one, whose files the others get. One that fails does not end the
// others, but a signal does; the exit code is that of the first that failed. Errors: kUsage.
int runFrames(const Options& options, Log& log);

}  // namespace pm::host
