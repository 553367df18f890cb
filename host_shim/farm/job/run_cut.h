// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstddef>
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

// What a frame takes one machine.
struct FrameSeconds {
    double buckets{};   // all of them
    double eachRun{1};  // whatever a run costs besides its buckets: start, maps of all passes
};

// How many runs a frame is cut into where nobody says it. More runs wait less for the last one and
// cost more of what each run costs: as many as balance that, of half a minute each, no more than
// six for each machine or 300, one for each machine at least, and as many for one as for another.
// frames: that are rendered together, at least one; machines: 0 counts as one.
std::uint32_t runCount(const FrameSeconds& seconds, std::size_t frames, std::size_t machines);

}  // namespace pm::host
