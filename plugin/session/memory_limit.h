// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>

namespace pm::plugin {

// The most memory that a render may plan for, in bytes. limitGib: what the user asked for, or 0 for
// the least limit of the process's cgroups (version 2 or 1), or else 90 % of the machine's memory.
// Threads: any; reads small files.
std::uint64_t memoryLimitBytes(double limitGib);

// Of that, what the process does not hold yet; and no more than is left of its address space
// (ulimit -v). Threads: any; reads small files.
std::uint64_t memoryLeftBytes(double limitGib);

// Most memory that the whole process (the host's share included) has held at once, in bytes.
std::uint64_t peakResidentBytes();

constexpr double toGib(std::uint64_t bytes) {
    return static_cast<double>(bytes) / (1024.0 * 1024.0 * 1024.0);
}

}  // namespace pm::plugin
