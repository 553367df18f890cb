// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/report/bucket_times.h"

#include <fmt/format.h>

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

std::string BucketTimes::csv() const {
    std::string text = "bucket,x0,y0,x1,y1,seconds,passes\n";
    for (const Bucket& bucket : timed()) {
        const PmrRectangle& r = bucket.rectangle;
        text += fmt::format("{},{},{},{},{},{:.9f},{}\n", bucket.index, r.x0, r.y0, r.x1, r.y1,
                            bucket.seconds, bucket.timedPasses);
    }
    return text;
}

}  // namespace pm::host
