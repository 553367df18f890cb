// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "plugin/session/memory_limit.h"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <fstream>
#include <limits>
#include <string>
#include <system_error>
#include <utility>

#include "scheduler/buckets/cgroup_limits.h"

namespace pm::plugin {

namespace {

constexpr double kShareOfMachine = 0.9;

std::uint64_t machineBytes() {
    const long pages = ::sysconf(_SC_PHYS_PAGES);
    const long pageBytes = ::sysconf(_SC_PAGESIZE);
    if (pages <= 0 || pageBytes <= 0) return std::numeric_limits<std::uint64_t>::max() / 2;
    return static_cast<std::uint64_t>(pages) * static_cast<std::uint64_t>(pageBytes);
}

// Size of the address space and of what is resident, in bytes.
std::pair<std::uint64_t, std::uint64_t> usedBytes() {
    std::ifstream stream("/proc/self/statm");
    std::string line;
    std::getline(stream, line);
    std::array<std::uint64_t, 2> pages{};
    const char* at = line.data();
    for (std::uint64_t& value : pages) {
        const auto [end, error] = std::from_chars(at, line.data() + line.size(), value);
        if (error != std::errc()) return {0, 0};
        at = end + 1;
    }
    const auto pageBytes = static_cast<std::uint64_t>(std::max(0l, ::sysconf(_SC_PAGESIZE)));
    return {pages[0] * pageBytes, pages[1] * pageBytes};
}

}  // namespace

std::uint64_t memoryLimitBytes(double limitGib) {
    if (limitGib > 0.0) return static_cast<std::uint64_t>(limitGib * (1024.0 * 1024.0 * 1024.0));
    const auto share =
        static_cast<std::uint64_t>(kShareOfMachine * static_cast<double>(machineBytes()));
    return std::min(share, cgroupMemoryLimit().value_or(share));
}

std::uint64_t memoryLeftBytes(double limitGib) {
    const auto [space, resident] = usedBytes();
    const std::uint64_t limit = memoryLimitBytes(limitGib);
    const std::uint64_t left = limit - std::min(limit, resident);
    rlimit addresses{};
    if (::getrlimit(RLIMIT_AS, &addresses) != 0 || addresses.rlim_cur == RLIM_INFINITY) return left;
    return std::min<std::uint64_t>(left, addresses.rlim_cur - std::min(addresses.rlim_cur, space));
}

std::uint64_t peakResidentBytes() {
    rusage usage{};
    if (::getrusage(RUSAGE_SELF, &usage) != 0 || usage.ru_maxrss < 0) return 0;
    return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
}

}  // namespace pm::plugin
