// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// A walk through the interface, repeated with one allocation failing after the other, in processes
// that may crash.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tests/alloc/small_host.h"

namespace pm::test {

// What one failed allocation led to that it must not.
struct Finding {
    std::uint64_t number = 0;  // of the allocation, from 1
    std::string what;          // "crash (signal 11)", "leak", ...
    std::string failedStack;   // where memory was refused, innermost first
    std::string crashStack;    // where it crashed
    // "LIBRARY FUNCTION" that pm had called and in which memory was refused; empty within pm.
    std::string below;
    bool isStatus = false;  // of a call that ended otherwise than for lack of memory
};

// warm: in a process that has gone the same way before, so that what is made once is there. cold:
// each in a new process, so that what is made once may fail as well; leaks are not looked for.
enum class Start { kWarm, kCold };

// The number of allocations of the walk when none fails.
std::uint64_t countAllocations(const PmrApi& api, const Walk& walk, const char* folder,
                               Start start);

// Goes the walk once for each number. Files of the walk lie in `folder`.
std::vector<Finding> walkFailing(const PmrApi& api, const Walk& walk, const char* folder,
                                 Start start, const std::vector<std::uint64_t>& numbers);

}  // namespace pm::test
