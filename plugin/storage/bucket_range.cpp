// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "plugin/storage/bucket_range.h"

#include <fmt/format.h>

#include <charconv>
#include <system_error>

#include "plugin/values/call_error.h"

namespace pm::plugin {

namespace {

// A:B or I/N as it is written.
struct Written {
    char separator = ':';
    std::uint32_t left = 0, right = 0;
};

CallError refuse(std::string_view text, const std::string& allowed) {
    return argumentError(fmt::format("setting buckets is '{}'; it must be {}", text, allowed));
}

bool parse(std::string_view text, std::uint32_t& value) {
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    return error == std::errc() && end == text.data() + text.size();
}

Written readWritten(std::string_view text) {
    const std::size_t at = text.find_first_of(":/");
    Written written;
    if (at == std::string_view::npos || !parse(text.substr(0, at), written.left) ||
        !parse(text.substr(at + 1), written.right))
        throw refuse(text, "A:B, I/N or empty, in whole numbers");
    written.separator = text[at];
    const bool isRun = written.separator == '/';
    if (isRun ? written.left < 1 || written.left > written.right : written.left >= written.right)
        throw refuse(text, isRun ? "I/N with I from 1 to N" : "A:B with A below B");
    return written;
}

}  // namespace

void checkBucketRange(std::string_view text) {
    if (!text.empty()) readWritten(text);
}

BucketRange bucketRange(std::string_view text, std::uint32_t bucketCount) {
    if (text.empty()) return {0, bucketCount};
    const Written written = readWritten(text);
    BucketRange range{written.left, written.right};
    if (written.separator == '/') {
        const auto end = [&](std::uint32_t run) {
            return static_cast<std::uint32_t>(std::uint64_t{run} * bucketCount / written.right);
        };
        range = {end(written.left - 1), end(written.left)};
    }
    if (range.last > bucketCount || range.count() == 0)
        throw refuse(
            text, fmt::format("within the {} buckets of the picture and not empty", bucketCount));
    return range;
}

std::string rangeText(const BucketRange& range) {
    return fmt::format("{}:{}", range.first, range.last);
}

std::vector<BucketRange> missingRanges(const std::vector<bool>& present) {
    std::vector<BucketRange> ranges;
    for (std::uint32_t i = 0; i < present.size(); ++i) {
        if (present[i]) continue;
        if (!ranges.empty() && ranges.back().last == i)
            ++ranges.back().last;
        else
            ranges.push_back({i, i + 1});
    }
    return ranges;
}

}  // namespace pm::plugin
