// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/cli/check_options.h"

#include <limits>

#include "host_shim/cli/option_values.h"
#include "host_shim/values/host_error.h"

namespace pm::host {

void readCheck(const Typed& typed, CheckOptions& check) {
    if (typed.checkSuite.empty())
        throw HostError(ExitCode::kUsage,
                        "no SUITE.json given; usage: pm_host check SUITE.json [options], see "
                        "pm_host check -h");
    check.suite = typed.checkSuite;
    check.only = typed.onlyScenes;
    if (!typed.jobs.empty())
        check.jobs = static_cast<int>(integerValue("--jobs", typed.jobs, 1, 1024));
    if (!typed.seeds.empty())
        check.seeds = static_cast<int>(integerValue("--seeds", typed.seeds, 4, 64));
    if (!typed.timeBudget.empty())
        check.timeBudgetSeconds = numberValue("--time-budget", typed.timeBudget, 0, 1e9);
    if (!typed.seed.empty())
        check.seed = static_cast<std::uint64_t>(
            integerValue("--seed", typed.seed, 0, std::numeric_limits<std::int64_t>::max()));
    if (check.update && check.because.empty())
        throw HostError(ExitCode::kUsage, "--update wants --because TEXT: why references change");
    if (!check.update && (!check.because.empty() || !typed.seeds.empty()))
        throw HostError(ExitCode::kUsage, "--because and --seeds are of --update");
    if (check.update && check.seed)
        throw HostError(ExitCode::kUsage,
                        "--update and --seed: references have seeds of their own");
}

}  // namespace pm::host
