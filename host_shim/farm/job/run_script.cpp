// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/farm/job/run_script.h"

#include <fmt/format.h>

#include <cstdlib>
#include <filesystem>
#include <string_view>

#include "host_shim/report/report_command.h"

namespace pm::host {
namespace {

// In two halves: between them the variables and the folder of the plan.
constexpr std::string_view kScript = R"sh(#!/bin/sh
# Made by pm_host farm. usage: sh run.sh TASK [options]: makes a task of tasks.txt, which is beside
# this file; its exit code is pm_host's.
job=$(cd -- "$(dirname -- "$0")" && pwd -P) || exit 4
task=$1
shift
name=$(printf '%04d' "$task") || exit 2
log=$job/logs/$name
machine=${SLURMD_NODENAME:-$(uname -n)}
line=$(sed -n "${task}p" "$job/tasks.txt")
if [ -z "$line" ]; then
    echo "run.sh: $job/tasks.txt: has no task $task" >&2
    exit 4
fi
note() { echo "$1 $(date +%s.%N) $machine $$${2:+ $2}" >>"$log.events"; }

# The same task may run elsewhere at this moment, as when a machine was cut off and still works. They
# make the same part; the checkpoint is one's alone.
exec 9>>"$job/locks/$name"
case " $line " in
    *" --photons-only "*) ;;
    *) if flock -n 9; then set -- --checkpoint "$job/checkpoints/$name.pmcheck" --resume "$@"; fi ;;
esac
)sh";

constexpr std::string_view kRest = R"sh(
note start
eval "$line \"\$@\"" >>"$log.log" 2>&1 &
child=$!
trap 'kill -TERM "$child" 2>/dev/null' TERM INT HUP
wait "$child"
code=$?
# A signal ends the waiting, not the child.
while kill -0 "$child" 2>/dev/null; do
    wait "$child"
    code=$?
done
note end "$code"
exit "$code"
)sh";

std::string quoted(const std::string& word) {
    return shellCommand({word});
}

// The variables that pm_host reads, as they are here; a path of them may be relative.
std::string variables() {
    std::string text;
    for (const char* name : {"PM_PLUGIN_PATH", "OCIO"}) {
        const char* const value = std::getenv(name);
        if (value != nullptr && *value != '\0')
            text += fmt::format("export {}={}\n", name, quoted(value));
        else
            text += fmt::format("unset {}\n", name);
    }
    return text;
}

}  // namespace

std::string taskLines(const FarmPlan& plan) {
    std::string text;
    for (const FarmTask& task : plan.tasks) {
        Arguments words{plan.program.string()};
        words.insert(words.end(), task.words.begin(), task.words.end());
        text += shellCommand(words) + "\n";
    }
    return text;
}

std::string runScriptText(const FarmPlan& plan) {
    return std::string(kScript) + "\n" + variables() +
           fmt::format("cd -- {} || exit 4\n", quoted(plan.folder.string())) + std::string(kRest);
}

}  // namespace pm::host
