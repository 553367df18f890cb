// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "host_shim/farm/job/farm_plan.h"

namespace pm::host {

// The folder of a job, which all of its machines see: what is planned and what is done.
class JobFolder {
  public:
    // Nothing is made before prepare(). The path is made absolute.
    explicit JobFolder(const std::filesystem::path& folder);
    ~JobFolder();
    JobFolder(const JobFolder&) = delete;
    JobFolder& operator=(const JobFolder&) = delete;

    const std::filesystem::path& path() const { return m_folder; }
    std::filesystem::path part(int task) const;
    std::filesystem::path photons(std::size_t frame) const;
    std::filesystem::path statistics(int task) const;
    std::filesystem::path log(int task) const;
    std::filesystem::path events(int task) const;
    std::filesystem::path page() const { return m_folder / "farm.html"; }
    std::filesystem::path engineState() const { return m_folder / "engine.json"; }
    std::filesystem::path engineLog() const { return m_folder / "logs" / "engine.log"; }
    std::filesystem::path runScript() const { return m_folder / "run.sh"; }

    // The plan that is there, if any. Errors: kFile, kBadInput.
    std::optional<FarmPlan> readPlan() const;
    // Errors: kFile for a folder that has files and is no job's.
    void check() const;
    // The same; makes the folder where it isn't there, and keeps others out while this lives.
    // Errors: kFile, also where another process has it.
    void prepare();
    // Writes the plan, the list of tasks and the script that makes one of them. Errors: kFile.
    void writePlan(const FarmPlan& plan) const;

  private:
    std::filesystem::path m_folder;
    int m_lock{-1};
};

}  // namespace pm::host
