// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include "host_shim/cli/options.h"
#include "host_shim/log/log.h"

namespace pm::host {

// pm_host farm SCENE: photons once, runs of buckets on many machines, then the pictures. The job's
// folder keeps what is done; the same command line goes on from there. Returns the exit code.
// Errors: those of its tasks where another machine could not do better, or all tries have failed;
// Interrupted, after all tasks were ended.
int runFarm(const Options& options, Log& log);

}  // namespace pm::host
