// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>
#include <vector>

namespace pm::host {

// Buckets that follow each other in their order, half-open, and what they cost.
struct BucketRun {
    std::uint32_t first{}, last{};
    double cost{};
};

// Cuts bucketCount buckets into runs of about the same cost, none empty; fewer than `runs` where
// there are fewer buckets. pilotCosts: what the buckets of a smaller picture cost, in the same
// order, which runs through both pictures alike; of another number they tell what a stretch of the
// order costs. Without a cost above 0 all buckets count the same.
std::vector<BucketRun> cutRuns(const std::vector<double>& pilotCosts, std::uint32_t bucketCount,
                               std::uint32_t runs);

}  // namespace pm::host
