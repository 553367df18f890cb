// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/report/bucket_times.h"

#include <algorithm>

namespace pm::host {

void BucketTimes::finished(const PmrBucketInfo& info) {
    const std::size_t count = std::max(info.bucketCount, info.bucketIndex + 1);
    if (m_buckets.size() < count) m_buckets.resize(count);
    m_buckets[info.bucketIndex] = {info.rectangle, info.bucketIndex, info.seconds, info.timedPasses,
                                   info.cacheBytes};
}

std::vector<BucketTimes::Bucket> BucketTimes::timed() const {
    std::vector<Bucket> buckets;
    for (const Bucket& bucket : m_buckets)
        if (bucket.timedPasses > 0) buckets.push_back(bucket);
    return buckets;
}

}  // namespace pm::host
