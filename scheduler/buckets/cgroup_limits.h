// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace pm {

// Where the system tells of cgroups; others in tests.
struct CgroupPlaces {
    std::string ofProcess = "/proc/self/cgroup";
    std::string root = "/sys/fs/cgroup";
};

// What cgroups (version 2 and 1) allow this process, nothing where there is no limit. The least
// counts from the process's own group up to the root. Threads: any; they read small files.
// In processors: 2.5 is two and a half.
std::optional<double> cgroupProcessorLimit(const CgroupPlaces& places = {});
// In bytes.
std::optional<std::uint64_t> cgroupMemoryLimit(const CgroupPlaces& places = {});

}  // namespace pm
