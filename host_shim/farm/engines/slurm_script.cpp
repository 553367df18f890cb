// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/farm/engines/slurm_script.h"

#include <fmt/format.h>

#include "host_shim/report/report_command.h"

namespace pm::host {
namespace {

// Slurm starts a task again by itself after a node's death or a preemption, and after exit codes
// where a site says so (RequeueExit). However it was set, that ends some time.
constexpr int kMostRestarts = 200;

}  // namespace

std::filesystem::path slurmScript(const JobFolder& folder) {
    return folder.path() / "slurm.sh";
}

std::string slurmScriptText(const JobFolder& folder) {
    return fmt::format(
        R"sh(#!/bin/sh
# Made by pm_host farm. Slurm copies this file, so it names the other one in full.
task=$((SLURM_ARRAY_TASK_ID + ${{PM_FARM_OFFSET:-0}}))
if [ "${{SLURM_RESTART_COUNT:-0}}" -gt {} ]; then
    echo "slurm.sh: task $task was started again $SLURM_RESTART_COUNT times, which is enough" >&2
    exit 2
fi
# Whole nodes have all of their processors for one task; who asks sbatch for some of them gets
# these.
exec sh {} "$task" ${{SLURM_CPUS_PER_TASK:+--threads "$SLURM_CPUS_PER_TASK"}}
)sh",
        kMostRestarts, shellCommand({folder.runScript().string()}));
}

}  // namespace pm::host
