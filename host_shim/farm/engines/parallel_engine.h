// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <deque>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "host_shim/farm/engines/engine.h"
#include "host_shim/process/program.h"

namespace pm::host {

// GNU parallel on this machine, or on others over ssh that see the same folders. It lives as long
// as this object: what an earlier process started is not known here.
class ParallelEngine : public Engine {
  public:
    ParallelEngine(const FarmOptions& options, const JobFolder& folder, Log& log);

    std::vector<FarmMachine> machines() override;
    void start(const Order& order) override;
    std::set<int> unfinished() override;
    void cancel() override;
    std::string preview(const Order& order) const override;

  private:
    struct Batch {
        std::vector<int> tasks;
        bool needsTheLast{};  // all of the batch before it must have ended with 0
    };
    std::vector<std::string> words(const std::vector<int>& tasks) const;
    void startNext();

    const FarmOptions& m_options;
    const JobFolder& m_folder;
    Log& m_log;
    std::deque<Batch> m_waiting;
    Batch m_current;
    std::unique_ptr<BackgroundProgram> m_program;
    bool m_lastFailed{};
};

}  // namespace pm::host
