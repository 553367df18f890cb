// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <memory>
#include <set>
#include <string>
#include <vector>

#include "host_shim/cli/options.h"
#include "host_shim/farm/job/job_folder.h"
#include "host_shim/log/log.h"

namespace pm::host {

// A machine that tasks may run on.
struct FarmMachine {
    std::string name;
    std::string cpuFlags;  // as Linux's /proc/cpuinfo has them; empty where they are not known
};

// What starts tasks on machines: a farm manager that is there already. Tasks are known by their
// numbers in the plan; `sh run.sh NUMBER` in the job's folder makes one.
class Engine {
  public:
    virtual ~Engine() = default;

    // The machines that are up, asked for how their processors are where that takes no more than
    // seconds.
    virtual std::vector<FarmMachine> machines() = 0;
    // Tasks that begin now, those that begin once all of the first have ended with 0, and machines
    // that had better not get them, as they failed there.
    struct Order {
        std::vector<int> first, then;
        std::set<std::string> avoid;
    };
    // Hands tasks over; returns before they run. Errors: kUsage where the engine refuses.
    virtual void start(const Order& order) = 0;
    // Those that wait or run, also of an earlier process that had this job in hand.
    virtual std::set<int> unfinished() = 0;
    // Ends all that wait or run; throws nothing.
    virtual void cancel() = 0;
    // What start() would call, a line each.
    virtual std::string preview(const Order& order) const = 0;
};

// By name: slurm or parallel. folder and log must outlive it.
std::unique_ptr<Engine> makeEngine(const FarmOptions& options, const JobFolder& folder, Log& log);

}  // namespace pm::host
