// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <chrono>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "host_shim/farm/engines/engine.h"
#include "host_shim/farm/job/farm_plan.h"
#include "host_shim/farm/job/job_folder.h"
#include "host_shim/log/log.h"

namespace pm::host {

// Which tasks of a plan are done, and how often the others were tried. A task is done when its
// product is there: a name means that the file is whole.
class TaskBoard {
  public:
    // tries: how often a task is started at most.
    TaskBoard(const FarmPlan& plan, const JobFolder& folder, int tries, Log& log);

    // Looks for products; those that have come since the last look.
    std::vector<int> lookForProducts();
    // Its product was of no use.
    void reopen(int task) { m_open.insert(task); }
    const std::set<int>& open() const { return m_open; }
    // Photons that are not there, and the runs of these frames; then the runs that can begin.
    struct Batches {
        std::vector<int> photons, runsAfter, runs;
    };
    Batches batches(const std::set<int>& tasks) const;
    // Starts tasks. Errors: those of the engine.
    void start(const std::set<int>& tasks, Engine& engine);
    // Of those that the engine is done with, those to be started again; some seconds pass before
    // that, as files come late over a network. Errors: what ended a task for good.
    std::set<int> lost(const std::set<int>& unfinished);
    // How much of the predicted work is done, from 0 to 1.
    double fraction() const;

  private:
    void judge(int task);
    std::set<std::string> failedOn(const std::set<int>& tasks) const;

    const FarmPlan& m_plan;
    const JobFolder& m_folder;
    int m_mostTries;
    Log& m_log;
    std::set<int> m_open;
    std::map<int, int> m_tries;
    std::map<int, std::size_t> m_attemptsBefore;  // that were noted when it was started
    std::map<int, std::chrono::steady_clock::time_point> m_goneSince;
};

}  // namespace pm::host
