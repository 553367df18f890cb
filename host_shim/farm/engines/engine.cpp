// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/farm/engines/engine.h"

#include "host_shim/farm/engines/parallel_engine.h"
#include "host_shim/farm/engines/slurm_engine.h"

namespace pm::host {

std::unique_ptr<Engine> makeEngine(const FarmOptions& options, const JobFolder& folder, Log& log) {
    if (options.engine == "slurm") return std::make_unique<SlurmEngine>(options, folder, log);
    return std::make_unique<ParallelEngine>(options, folder, log);
}

}  // namespace pm::host
