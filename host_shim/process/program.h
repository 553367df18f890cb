// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <sys/types.h>

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace pm::host {

// What a program left that has ended.
struct ProgramEnd {
    int code{};  // exit code, or 128 and the signal's number
    std::string out, err;
};

// Runs a program that is found as a shell finds it, to its end or until so much time has passed:
// then it is asked to end, and killed soon after. It reads nothing, and signals of the terminal
// don't reach it. Errors: kUsage where it can't be started.
ProgramEnd runProgram(const std::vector<std::string>& words,
                      std::chrono::milliseconds limit = std::chrono::minutes(2));

// A program that runs beside this one, with all that it starts a group of processes of its own,
// which ends with this object.
class BackgroundProgram {
  public:
    // log: what it prints is appended there. Errors: kUsage where it can't be started.
    BackgroundProgram(const std::vector<std::string>& words, const std::filesystem::path& log);
    ~BackgroundProgram();
    BackgroundProgram(const BackgroundProgram&) = delete;
    BackgroundProgram& operator=(const BackgroundProgram&) = delete;

    // Its exit code, or 128 and the signal's number, once it has ended.
    std::optional<int> ended();
    // Asks it to end, twice, as some begin by waiting for what they have started; after a few
    // seconds kills the group.
    void end();

  private:
    pid_t m_child{};
    std::optional<int> m_code;
};

}  // namespace pm::host
