// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "plugin/include/pm_plugin.h"

namespace pm::host {

// How long each bucket took, as the plugin measured it. For one thread at a time.
class BucketTimes {
  public:
    struct Bucket {
        PmrRectangle rectangle{};
        std::uint32_t index{};        // its place in the bucket order
        double seconds{};             // of all passes that were timed
        std::uint32_t timedPasses{};  // those that were rendered here
        std::uint64_t cacheBytes{};   // that bounded caches missed, of all of these
        double perPass(double ofAll) const { return timedPasses == 0 ? 0 : ofAll / timedPasses; }
        double secondsPerPass() const { return perPass(seconds); }
        double cacheMibPerPass() const {
            return perPass(static_cast<double>(cacheBytes) / (1 << 20));
        }
    };

    void finished(const PmrBucketInfo& info);
    // Those with a timed pass, in the order of index.
    std::vector<Bucket> timed() const;
    // The same as lines "bucket,x0,y0,x1,y1,seconds,passes" below a line of these names.
    std::string csv() const;

  private:
    std::vector<Bucket> m_buckets;  // by index
};

}  // namespace pm::host
