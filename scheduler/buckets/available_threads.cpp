// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "scheduler/buckets/available_threads.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>
#include <thread>

#if defined(__linux__)
#include <sched.h>

#include <vector>
#endif

namespace pm {
namespace {

namespace fs = std::filesystem;

std::string readText(const fs::path& file) {
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

// The integer at the head of text, which is cut off together with the blank behind it.
std::optional<std::int64_t> takeInteger(std::string_view& text) {
    std::int64_t value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{}) return std::nullopt;
    text.remove_prefix(static_cast<std::size_t>(end - text.data()));
    if (!text.empty()) text.remove_prefix(1);
    return value;
}

std::optional<double> quotient(std::optional<std::int64_t> quota,
                               std::optional<std::int64_t> period) {
    if (!quota || !period || *quota <= 0 || *period <= 0) return std::nullopt;
    return static_cast<double>(*quota) / static_cast<double>(*period);
}

// Version 2: "QUOTA PERIOD" in microseconds, or "max PERIOD".
std::optional<double> limitOfFolderV2(const fs::path& folder) {
    const std::string content = readText(folder / "cpu.max");
    std::string_view text = content;
    const auto quota = takeInteger(text);
    return quotient(quota, takeInteger(text));
}

// Version 1: one number a file, a quota of -1 for none.
std::optional<double> limitOfFolderV1(const fs::path& folder) {
    const std::string quotaText = readText(folder / "cpu.cfs_quota_us");
    const std::string periodText = readText(folder / "cpu.cfs_period_us");
    std::string_view quota = quotaText, period = periodText;
    return quotient(takeInteger(quota), takeInteger(period));
}

void keepLeast(std::optional<double>& least, std::optional<double> limit) {
    if (limit && (!least || *limit < *least)) least = limit;
}

// From the group's folder up to the root. Within a container the group's path may be the host's
// and not exist here: then the root, which is always looked at, is the container's own group.
template <typename LimitOfFolder>
void lookUpwards(std::optional<double>& least, const fs::path& root, std::string_view group,
                 LimitOfFolder limitOfFolder) {
    keepLeast(least, limitOfFolder(root));
    fs::path relative = fs::path(group).relative_path().lexically_normal();
    if (!relative.empty() && *relative.begin() == "..") return;
    for (; !relative.empty() && relative != "."; relative = relative.parent_path()) {
        keepLeast(least, limitOfFolder(root / relative));
    }
}

bool namesCpu(std::string_view controllers) {
    while (!controllers.empty()) {
        const std::size_t comma = std::min(controllers.find(','), controllers.size());
        if (controllers.substr(0, comma) == "cpu") return true;
        controllers.remove_prefix(std::min(comma + 1, controllers.size()));
    }
    return false;
}

int affinityProcessors() {
#if defined(__linux__)
    // The kernel refuses a mask smaller than its own, whose size it does not tell.
    for (std::size_t sets = 1; sets <= 256; sets *= 2) {
        std::vector<cpu_set_t> mask(sets);
        const std::size_t bytes = sets * sizeof(cpu_set_t);
        if (sched_getaffinity(0, bytes, mask.data()) == 0) return CPU_COUNT_S(bytes, mask.data());
    }
#endif
    return static_cast<int>(std::thread::hardware_concurrency());
}

}  // namespace

std::optional<double> cgroupProcessorLimit(const fs::path& procCgroup, const fs::path& cgroupRoot) {
    std::optional<double> least;
    std::ifstream stream(procCgroup);
    // Each line: "HIERARCHY:CONTROLLERS:GROUP"; version 2 is hierarchy 0 without controllers.
    for (std::string text; std::getline(stream, text);) {
        const std::size_t first = text.find(':');
        const std::size_t second = first == std::string::npos ? first : text.find(':', first + 1);
        if (second == std::string::npos) continue;
        const std::string_view line = text;
        const std::string_view controllers = line.substr(first + 1, second - first - 1);
        const std::string_view group = line.substr(second + 1);
        if (controllers.empty()) {
            lookUpwards(least, cgroupRoot, group, limitOfFolderV2);
            lookUpwards(least, cgroupRoot / "unified", group, limitOfFolderV2);
        } else if (namesCpu(controllers)) {
            lookUpwards(least, cgroupRoot / controllers, group, limitOfFolderV1);
            lookUpwards(least, cgroupRoot / "cpu", group, limitOfFolderV1);
        }
    }
    return least;
}

int availableThreads() {
    const int processors = std::max(1, affinityProcessors());
    const auto limit = cgroupProcessorLimit("/proc/self/cgroup", "/sys/fs/cgroup");
    if (!limit || *limit >= processors) return processors;
    return std::max(1, static_cast<int>(std::ceil(*limit)));
}

}  // namespace pm
