// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "plugin/session/memory_limit.h"

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <fstream>
#include <limits>
#include <optional>
#include <string>
#include <system_error>

namespace pm::plugin {

namespace {

constexpr double kShareOfMachine = 0.9;

// The number that a small file begins with; nothing for "max" or no file.
std::optional<std::uint64_t> readNumber(const std::string& file) {
    std::ifstream stream(file);
    std::string line;
    if (!std::getline(stream, line)) return std::nullopt;
    std::uint64_t value = 0;
    const auto [end, error] = std::from_chars(line.data(), line.data() + line.size(), value);
    if (error != std::errc()) return std::nullopt;
    return value;
}

// The least limit from a group ("/a/b") up to the root of its hierarchy. Names are put together as
// text: std::filesystem::path frees memory twice where its operator/= gets none (libstdc++ 12).
std::uint64_t leastLimit(const std::string& root, std::string group, const std::string& file) {
    std::uint64_t least = std::numeric_limits<std::uint64_t>::max();
    while (true) {
        while (!group.empty() && group.back() == '/') group.pop_back();
        if (const auto limit = readNumber(root + group + '/' + file))
            least = std::min(least, *limit);
        if (group.empty()) return least;
        group.resize(std::min(group.rfind('/'), group.size() - 1));
    }
}

std::uint64_t cgroupLimitBytes() {
    std::uint64_t least = std::numeric_limits<std::uint64_t>::max();
    std::ifstream groups("/proc/self/cgroup");
    for (std::string line; std::getline(groups, line);) {
        const std::size_t first = line.find(':');
        const std::size_t second = line.find(':', first + 1);
        if (first == std::string::npos || second == std::string::npos) continue;
        const std::string controllers =
            fmt::format(",{},", line.substr(first + 1, second - first - 1));
        const std::string group = line.substr(second + 1);
        if (controllers == ",,")
            least = std::min(least, leastLimit("/sys/fs/cgroup", group, "memory.max"));
        else if (controllers.find(",memory,") != std::string::npos)
            least = std::min(least,
                             leastLimit("/sys/fs/cgroup/memory", group, "memory.limit_in_bytes"));
    }
    return least;
}

std::uint64_t machineBytes() {
    const long pages = ::sysconf(_SC_PHYS_PAGES);
    const long pageBytes = ::sysconf(_SC_PAGESIZE);
    if (pages <= 0 || pageBytes <= 0) return std::numeric_limits<std::uint64_t>::max() / 2;
    return static_cast<std::uint64_t>(pages) * static_cast<std::uint64_t>(pageBytes);
}

}  // namespace

std::uint64_t memoryLimitBytes(double limitGib) {
    if (limitGib > 0.0) return static_cast<std::uint64_t>(limitGib * (1024.0 * 1024.0 * 1024.0));
    const auto share =
        static_cast<std::uint64_t>(kShareOfMachine * static_cast<double>(machineBytes()));
    return std::min(share, cgroupLimitBytes());
}

std::uint64_t peakResidentBytes() {
    rusage usage{};
    if (::getrusage(RUSAGE_SELF, &usage) != 0 || usage.ru_maxrss < 0) return 0;
    return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
}

}  // namespace pm::plugin
