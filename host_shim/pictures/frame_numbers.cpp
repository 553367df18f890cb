// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/pictures/frame_numbers.h"

#include <OpenImageIO/filesystem.h>
#include <fmt/format.h>

#include <algorithm>
#include <regex>
#include <set>

#include "host_shim/values/host_error.h"

namespace pm::host {
namespace {

constexpr std::size_t kMostFrames = 100'000;

[[noreturn]] void refuse(const std::string& option, const std::string& text) {
    throw HostError(
        ExitCode::kUsage,
        fmt::format("{} '{}': frames such as 7, 1-10, 1-10x2 or 1-5,8 are wanted, at most {}",
                    option, text, kMostFrames));
}

// OpenImageIO takes any text, and any number of frames. Six digits keep a range below a million.
bool isSequence(const std::string& text) {
    constexpr std::size_t kLongest = 32;  // of what has this shape
    if (text.size() > kLongest) return false;
    static const std::regex shape(R"(\d{1,6}(-\d{1,6}([xy]-?[1-9]\d{0,5})?)?)");
    return std::regex_match(text, shape);
}

}  // namespace

std::vector<std::int64_t> frameNumbers(const std::string& option, const std::string& text) {
    std::vector<std::int64_t> frames;
    std::set<int> known;
    std::size_t begin = 0;
    while (begin <= text.size()) {
        const std::size_t end = std::min(text.find(',', begin), text.size());
        const std::string part = text.substr(begin, end - begin);
        begin = end + 1;
        std::vector<int> listed;
        if (!isSequence(part) || !OIIO::Filesystem::enumerate_sequence(part, listed))
            refuse(option, text);
        for (const int frame : listed)
            if (known.insert(frame).second) frames.push_back(frame);
        if (frames.size() > kMostFrames) refuse(option, text);
    }
    if (frames.empty() || *known.begin() < 0) refuse(option, text);
    return frames;
}

}  // namespace pm::host
