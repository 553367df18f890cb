// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/app/bucket_times.h"

#include <algorithm>

namespace pm::host {

BucketTimes::Running& BucketTimes::at(const PmrBucketInfo& info) {
    const std::size_t count = std::max(info.bucketCount, info.bucketIndex + 1);
    if (m_buckets.size() < count) m_buckets.resize(count);
    Running& running = m_buckets[info.bucketIndex];
    running.bucket.rectangle = info.rectangle;
    running.bucket.index = info.bucketIndex;
    return running;
}

void BucketTimes::started(const PmrBucketInfo& info, double now) {
    Running& running = at(info);
    running.startedAt = now;
    running.pass = info.passIndex;
}

void BucketTimes::finished(const PmrBucketInfo& info, double now) {
    Running& running = at(info);
    // A start is not told while an earlier event waits, nor for what comes from a checkpoint.
    if (running.pass == static_cast<std::int64_t>(info.passIndex)) {
        running.bucket.seconds += std::max(now - running.startedAt, 0.0);
        ++running.bucket.timedPasses;
    }
    running.pass = -1;
}

std::vector<BucketTimes::Bucket> BucketTimes::timed() const {
    std::vector<Bucket> buckets;
    for (const Running& running : m_buckets)
        if (running.bucket.timedPasses > 0) buckets.push_back(running.bucket);
    return buckets;
}

}  // namespace pm::host
