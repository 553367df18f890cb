// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/farm/job/run_cut.h"

#include <algorithm>
#include <cmath>

namespace pm::host {
namespace {

// A second of dispatch is nothing to half a minute, and a machine that is slower than others has
// less to end with where there are several runs for each.
constexpr double kShortestRunSeconds = 30;
constexpr std::size_t kRunsOfAMachine = 6;
constexpr std::size_t kMostRuns = 300;

// Sums of what was before, from 0 to all.
std::vector<double> sumsOf(const std::vector<double>& costs) {
    std::vector<double> sums{0};
    for (const double cost : costs) sums.push_back(sums.back() + std::max(cost, 0.0));
    return sums;
}

// What the first `share` of the order costs, share from 0 to 1.
double costAt(const std::vector<double>& sums, double share) {
    const double place = share * static_cast<double>(sums.size() - 1);
    const auto below = std::min(static_cast<std::size_t>(place), sums.size() - 2);
    return std::lerp(sums[below], sums[below + 1], place - static_cast<double>(below));
}

}  // namespace

std::vector<BucketRun> cutRuns(const std::vector<double>& pilotCosts, std::uint32_t bucketCount,
                               std::uint32_t runs) {
    std::vector<double> sums = sumsOf(pilotCosts);
    if (!(sums.back() > 0) || !std::isfinite(sums.back())) sums = {0, 1};
    const auto costBefore = [&](std::uint32_t bucket) {
        return costAt(sums, static_cast<double>(bucket) / bucketCount);
    };
    const std::uint32_t count = std::clamp(runs, 1u, std::max(bucketCount, 1u));
    std::vector<BucketRun> cut;
    std::uint32_t first = 0;
    for (std::uint32_t i = 1; i <= count && first < bucketCount; ++i) {
        const double aim = sums.back() * i / count;
        const std::uint32_t most = bucketCount - (count - i);  // those that follow have one each
        std::uint32_t last = first + 1;
        // The nearer of the two borders of the bucket in which the aim lies.
        while (last < most &&
               std::abs(costBefore(last + 1) - aim) <= std::abs(costBefore(last) - aim))
            ++last;
        if (i == count) last = bucketCount;
        cut.push_back({first, last, costBefore(last) - costBefore(first)});
        first = last;
    }
    return cut;
}

std::uint32_t runCount(const FrameSeconds& seconds, std::size_t frames, std::size_t machines) {
    const std::size_t count = std::max<std::size_t>(machines, 1);
    const double work = std::max(seconds.buckets, 0.0);
    // n runs cost n eachRun / machines, for each frame, and half a run of waiting, work / 2n.
    const double best =
        std::sqrt(work * static_cast<double>(count) /
                  (2 * std::max(seconds.eachRun, 1e-3) * static_cast<double>(frames)));
    const auto useful = static_cast<std::size_t>(
        std::clamp(std::min(best, work / kShortestRunSeconds), 0.0, double{kMostRuns}));
    const std::size_t least = (count + frames - 1) / frames;
    const std::size_t most = std::max(least, std::min(kRunsOfAMachine * count, kMostRuns));
    const std::size_t runs = std::clamp(useful, least, most);
    return static_cast<std::uint32_t>(runs - runs % least);
}

}  // namespace pm::host
