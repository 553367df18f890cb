// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace pm::plugin {

// Some of a frame's buckets that follow each other in their order, half-open.
struct BucketRange {
    std::uint32_t first = 0, last = 0;
    std::uint32_t count() const { return last - first; }
    friend bool operator==(const BucketRange&, const BucketRange&) = default;
};

// The range that a text means of so many buckets: "" all of them, "A:B" those from A to B - 1,
// "I/N" the I-th (from 1) of N runs of the same length, but for one bucket.
// Errors: CallError(ARGUMENT) for another text, a range beyond the buckets or an empty one.
BucketRange bucketRange(std::string_view text, std::uint32_t bucketCount);

// The same without knowing how many buckets there are: whether the text can mean a range.
void checkBucketRange(std::string_view text);

// "A:B".
std::string rangeText(const BucketRange& range);

// The runs of false, in order.
std::vector<BucketRange> missingRanges(const std::vector<bool>& present);

}  // namespace pm::plugin
