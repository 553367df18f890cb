// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>

#include "integrator/values/rect.h"

namespace pm::plugin {

// What the host is told of a bucket, when it begins and when it is done.
struct BucketInfo {
    Rect rectangle;                 // of the window
    std::uint32_t bucketIndex = 0;  // its place in the order
    std::uint32_t bucketCount = 0;  // of one pass
    std::uint32_t passIndex = 0;    // the pass that just came, from 0
    std::uint32_t passCount = 0;    // at most
    std::uint64_t sampleCount = 0;  // camera samples in this bucket and pass
    double seconds = 0;             // wall time, drawn to rendered, of all passes that follow
    std::uint32_t timedPasses = 0;  // those that this render made
    // Of bounded caches, for all of these passes: values that had to be made or read, their bytes.
    std::uint64_t cacheMisses = 0, cacheBytes = 0;
};

}  // namespace pm::plugin
