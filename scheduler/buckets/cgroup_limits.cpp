// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Paths are put together as text: std::filesystem::path frees memory twice where its operator/=
// gets none (libstdc++ 12).
#include "scheduler/buckets/cgroup_limits.h"

#include <algorithm>
#include <charconv>
#include <fstream>
#include <iterator>
#include <string_view>

namespace pm {
namespace {

enum class Version { kOne, kTwo };

std::string readText(const std::string& file) {
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

// Version 2: "QUOTA PERIOD" in microseconds, or "max PERIOD". Version 1: one number a file, a quota
// of -1 for none.
std::optional<double> processorsOfFolder(const std::string& folder, Version version) {
    const bool isOne = version == Version::kOne;
    const std::string quotaText = readText(folder + (isOne ? "/cpu.cfs_quota_us" : "/cpu.max"));
    const std::string periodText = isOne ? readText(folder + "/cpu.cfs_period_us") : std::string();
    std::string_view text = quotaText;
    const auto quota = takeInteger(text);
    if (isOne) text = periodText;
    const auto period = takeInteger(text);
    if (!quota || !period || *quota <= 0 || *period <= 0) return std::nullopt;
    return static_cast<double>(*quota) / static_cast<double>(*period);
}

// One number, or "max".
std::optional<std::uint64_t> bytesOfFolder(const std::string& folder, Version version) {
    const char* const file = version == Version::kOne ? "/memory.limit_in_bytes" : "/memory.max";
    const std::string content = readText(folder + file);
    std::string_view text = content;
    const auto bytes = takeInteger(text);
    if (!bytes || *bytes < 0) return std::nullopt;
    return static_cast<std::uint64_t>(*bytes);
}

// The folders of a group ("/a/b") from its own up to the root. Within a container the group's path
// may be the host's and not exist here: then the root, which is always looked at, is the
// container's own group. One outside of the root ("/../c") is not looked for.
template <typename Look>
void lookUpwards(const std::string& root, std::string_view group, const Look& look) {
    look(root);
    if (group == "/.." || group.starts_with("/../")) return;
    while (!group.empty()) {
        if (group.ends_with('/')) {
            group.remove_suffix(1);
            continue;
        }
        look(root + std::string(group));
        const std::size_t slash = group.rfind('/');
        group = group.substr(0, slash == std::string_view::npos ? 0 : slash);
    }
}

bool names(std::string_view controllers, std::string_view controller) {
    while (!controllers.empty()) {
        const std::size_t comma = std::min(controllers.find(','), controllers.size());
        if (controllers.substr(0, comma) == controller) return true;
        controllers.remove_prefix(std::min(comma + 1, controllers.size()));
    }
    return false;
}

// limitOfFolder: of a folder and a version the limit that stands there, if any.
template <typename Limit>
std::optional<Limit> leastLimit(const CgroupPlaces& places, const std::string& controller,
                                std::optional<Limit> (*limitOfFolder)(const std::string&,
                                                                      Version)) {
    std::optional<Limit> least;
    const auto look = [&](const std::string& root, std::string_view group, Version version) {
        lookUpwards(root, group, [&](const std::string& folder) {
            const auto limit = limitOfFolder(folder, version);
            if (limit && (!least || *limit < *least)) least = limit;
        });
    };
    std::ifstream stream(places.ofProcess);
    // Each line: "HIERARCHY:CONTROLLERS:GROUP"; version 2 is hierarchy 0 without controllers.
    for (std::string text; std::getline(stream, text);) {
        const std::size_t first = text.find(':');
        const std::size_t second = first == std::string::npos ? first : text.find(':', first + 1);
        if (second == std::string::npos) continue;
        const std::string controllers = text.substr(first + 1, second - first - 1);
        const std::string_view group = std::string_view(text).substr(second + 1);
        if (controllers.empty()) {
            look(places.root, group, Version::kTwo);
            look(places.root + "/unified", group, Version::kTwo);
        } else if (names(controllers, controller)) {
            look(places.root + '/' + controllers, group, Version::kOne);
            look(places.root + '/' + controller, group, Version::kOne);
        }
    }
    return least;
}

}  // namespace

std::optional<double> cgroupProcessorLimit(const CgroupPlaces& places) {
    return leastLimit(places, "cpu", processorsOfFolder);
}

std::optional<std::uint64_t> cgroupMemoryLimit(const CgroupPlaces& places) {
    return leastLimit(places, "memory", bytesOfFolder);
}

}  // namespace pm
