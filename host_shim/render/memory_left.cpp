// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/render/memory_left.h"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <filesystem>
#include <fstream>
#include <limits>
#include <optional>
#include <string>
#include <utility>

namespace pm::host {
namespace {

constexpr double kShareOfMachine = 0.9;
constexpr double kGib = 1024.0 * 1024.0 * 1024.0;

// The number that a small file begins with; nothing for "max" or no file.
std::optional<std::uint64_t> firstNumber(const std::filesystem::path& file) {
    std::ifstream stream(file);
    std::string line;
    std::uint64_t value = 0;
    if (!std::getline(stream, line)) return std::nullopt;
    const auto [end, error] = std::from_chars(line.data(), line.data() + line.size(), value);
    return error == std::errc() ? std::optional(value) : std::nullopt;
}

// The least limit from the process's groups up to the roots, of version 2 and 1.
std::uint64_t cgroupLimit() {
    std::uint64_t least = std::numeric_limits<std::uint64_t>::max();
    std::ifstream groups("/proc/self/cgroup");
    for (std::string line; std::getline(groups, line);) {
        const std::size_t first = line.find(':'), second = line.find(':', first + 1);
        if (first == std::string::npos || second == std::string::npos) continue;
        const std::string controllers = line.substr(first + 1, second - first - 1);
        const bool isVersion2 = controllers.empty();
        if (!isVersion2 && controllers.find("memory") == std::string::npos) continue;
        const std::filesystem::path root = isVersion2 ? "/sys/fs/cgroup" : "/sys/fs/cgroup/memory";
        std::filesystem::path group = line.substr(second + 1);
        while (true) {
            const auto limit = firstNumber(root / group.relative_path() /
                                           (isVersion2 ? "memory.max" : "memory.limit_in_bytes"));
            least = std::min(least, limit.value_or(least));
            if (!group.has_relative_path()) break;
            group = group.parent_path();
        }
    }
    return least;
}

std::uint64_t pages(int name) {
    const long count = ::sysconf(name);
    return count > 0 ? static_cast<std::uint64_t>(count) : 0;
}

// Size of the address space and of what is resident, in bytes.
std::pair<std::uint64_t, std::uint64_t> usedBytes() {
    std::ifstream stream("/proc/self/statm");
    std::string line;
    std::getline(stream, line);
    std::array<std::uint64_t, 2> values{};
    const char* at = line.data();
    for (std::uint64_t& value : values) {
        const auto [end, error] = std::from_chars(at, line.data() + line.size(), value);
        if (error != std::errc()) return {0, 0};
        at = end + 1;
    }
    const std::uint64_t pageBytes = pages(_SC_PAGESIZE);
    return {values[0] * pageBytes, values[1] * pageBytes};
}

}  // namespace

std::uint64_t memoryLeftBytes(double limitGib) {
    const auto machine = static_cast<double>(pages(_SC_PHYS_PAGES) * pages(_SC_PAGESIZE));
    std::uint64_t limit =
        limitGib > 0
            ? static_cast<std::uint64_t>(limitGib * kGib)
            : std::min(static_cast<std::uint64_t>(kShareOfMachine * machine), cgroupLimit());
    const auto [space, resident] = usedBytes();
    limit -= std::min(limit, resident);
    rlimit addresses{};
    if (::getrlimit(RLIMIT_AS, &addresses) == 0 && addresses.rlim_cur != RLIM_INFINITY)
        limit = std::min<std::uint64_t>(limit,
                                        addresses.rlim_cur - std::min(addresses.rlim_cur, space));
    return limit;
}

}  // namespace pm::host
