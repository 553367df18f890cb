// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace pm::host {

// One time that a task was started on a machine.
struct TaskAttempt {
    std::string machine;
    std::string process;          // its number there
    double start{};               // seconds since 1970
    std::optional<double> end;    // nothing where it runs, or was killed
    std::optional<int> exitCode;  // of pm_host; with end
};

// What run.sh noted of a task: lines "start SECONDS MACHINE PROCESS" and "end SECONDS MACHINE
// PROCESS CODE". Lines that are torn, as two machines may write at once, are left out.
std::vector<TaskAttempt> readAttempts(const std::filesystem::path& file);

// How far the last attempt is, from 0 to 1, by the last line of --progress json in its log; 0 where
// there is none.
double readProgress(const std::filesystem::path& log);

// The last line of a log that is no progress; empty where there is none.
std::string lastMessage(const std::filesystem::path& log);

}  // namespace pm::host
