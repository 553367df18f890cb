// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace pm::host {

// One run of this program.
struct ChildTask {
    std::vector<std::string> arguments;  // without the program's name
    std::filesystem::path folder;        // it works there
    std::filesystem::path log;           // what it prints, standard output and error
};

struct ChildResult {
    enum class End { kNotStarted, kExited, kSignalled, kOutOfTime };
    End end{End::kNotStarted};
    int code{};  // exit code, or the signal's number
    double seconds{};
};

// Runs the tasks, `atOnce` at a time, in their order; after `budget` what runs is ended and what is
// left isn't started. done: called on this thread as each ends, with its index. A signal that this
// process gets ends them all (Interrupted). Errors: kInternal where none can be started.
std::vector<ChildResult> runChildren(
    const std::vector<ChildTask>& tasks, int atOnce, std::chrono::duration<double> budget,
    const std::function<void(std::size_t, const ChildResult&)>& done);

}  // namespace pm::host
