// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "host_shim/farm/engines/engine.h"

namespace pm::host {

// Slurm: tasks are elements of job arrays. They go on when this process ends, and are found again
// by their numbers, which the job's folder keeps.
class SlurmEngine : public Engine {
  public:
    // Reads which arrays an earlier process started. Errors: kBadInput.
    SlurmEngine(const FarmOptions& options, const JobFolder& folder, Log& log);

    std::vector<FarmMachine> machines() override;
    void start(const Order& order) override;
    std::set<int> unfinished() override;
    void cancel() override;
    std::string preview(const Order& order) const override;

  private:
    // Some tasks whose numbers share all but what an array's index may be.
    struct Slice {
        int offset{};
        std::vector<int> indices;
    };
    // Arrays that must have ended before, separated by colons, and nodes that are not to be taken,
    // by commas.
    struct Where {
        std::string after, exclude;
    };
    static std::set<std::string> nodesUp();
    std::string excluded(const std::set<std::string>& avoid);
    static std::vector<Slice> slicesOf(const std::vector<int>& tasks);
    std::vector<std::string> batchWords(const Slice& slice, const Where& where) const;
    // The numbers of the arrays, separated by colons, as a dependency takes them.
    std::string submit(const std::vector<int>& tasks, const Where& where);
    std::string submitSlice(const std::vector<std::string>& words);
    // What squeue says of our arrays; nothing where the controller doesn't answer.
    std::optional<std::string> queue();
    void release(const std::string& job, int task, const std::string& reason);
    void warnOfSilence(const std::string& text);
    void keep() const;

    const FarmOptions& m_options;
    const JobFolder& m_folder;
    Log& m_log;
    std::map<std::string, int> m_arrays;  // number -> offset of its indices
    std::set<int> m_known;                // the last answer
    std::map<int, int> m_releases;        // of a task, how often
    bool m_isSilent{};
};

}  // namespace pm::host
