// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// pm_host in forks of a process that has loaded all of its libraries, which takes longer than a
// small picture.
#pragma once

#include <sys/types.h>

#include <string>
#include <utility>
#include <vector>

namespace pm::host::test {

struct HostTask {
    std::string folder;                  // where it runs; it leaves .out and .err there
    std::vector<std::string> arguments;  // without the program's name
    std::vector<std::pair<std::string, std::string>> variables;
};

// A child that runs pm_host so, to be waited for by the caller as its own. The process that forks
// it is made before the first test, as long as there are no threads.
pid_t startInZygote(const HostTask& task);

// For a child, before pm_host: folder, output, and variables, with those cleared that colour,
// textures and locales listen to. False where that can't be done.
bool enterTask(const HostTask& task);

}  // namespace pm::host::test
