// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include "plugin/include/pm_plugin.h"

#include <cstdint>
#include <vector>

namespace pm::host {

// How long each bucket took, as the host sees it: wall time from its start to its end, between the
// two callbacks. For one thread at a time.
class BucketTimes {
  public:
    struct Bucket {
        PmrRectangle rectangle{};
        std::uint32_t index{};        // its place in the bucket order
        double seconds{};             // of all passes that were timed
        std::uint32_t timedPasses{};  // those whose start and end were both told
        double secondsPerPass() const { return timedPasses == 0 ? 0 : seconds / timedPasses; }
    };

    // now: seconds since any fixed time.
    void started(const PmrBucketInfo& info, double now);
    void finished(const PmrBucketInfo& info, double now);
    // Those with a timed pass, in the order of index.
    std::vector<Bucket> timed() const;

  private:
    struct Running {
        Bucket bucket;
        double startedAt{};
        std::int64_t pass{-1};  // that was started and has not ended
    };
    Running& at(const PmrBucketInfo& info);

    std::vector<Running> m_buckets;  // by index
};

}  // namespace pm::host
