// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "tests/bench/order/cache_replay.h"

#include <gtest/gtest.h>

#include <array>
#include <numeric>
#include <vector>

#include "scheduler/buckets/bucket_order.h"

namespace pm::bench {
namespace {

// Buckets on a grid over a plane of values, each of which sees its own and a rim of its
// neighbours'.
CacheTrace plane(std::uint32_t side, std::uint32_t perBucket, std::uint32_t rim) {
    TraceWatch watch(side * side);
    const std::uint32_t values = side * perBucket;
    const auto clamped = [&](std::uint32_t v) { return std::min(v, values - 1); };
    for (std::uint32_t cell = 0; cell < side * side; ++cell) {
        watch.begin(cell);
        const std::uint32_t x0 = cell % side * perBucket, y0 = cell / side * perBucket;
        for (std::uint32_t y = y0 < rim ? 0 : y0 - rim; y <= clamped(y0 + perBucket - 1 + rim); ++y)
            for (std::uint32_t x = x0 < rim ? 0 : x0 - rim; x <= clamped(x0 + perBucket - 1 + rim);
                 ++x)
                watch.asked({0, std::uint64_t{y} * values + x, 100, false, CacheUser::kCamera});
    }
    return watch.take();
}

std::vector<std::uint32_t> orderOf(const char* name, std::int32_t side) {
    return findBucketOrder(name)->cells(side, side, 1);
}

TEST(CacheReplay, WhatFitsIsMissedOnce) {
    const CacheTrace trace = plane(8, 4, 2);
    EXPECT_EQ(trace.workingSet(), 32u * 32u * 100u);
    for (const char* name : {"hilbert", "row", "random"}) {
        const CacheReplay all = replayCaches(trace, orderOf(name, 8), {trace.workingSet(), 1, 1});
        EXPECT_EQ(all.misses, 32u * 32u) << name;
        EXPECT_EQ(all.bytes, trace.workingSet()) << name;
    }
}

TEST(CacheReplay, NeighboursShareWhatACacheHolds) {
    const CacheTrace trace = plane(16, 4, 2);
    const auto misses = [&](const char* name, std::uint64_t share) {
        return replayCaches(trace, orderOf(name, 16), {trace.workingSet() / share, 1, 1}).misses;
    };
    // A sixteenth holds a row of buckets and more, or a quarter of the frame on the curve.
    EXPECT_LT(misses("hilbert", 16), 0.8 * static_cast<double>(misses("random", 16)));
    EXPECT_LT(misses("hilbert", 32), misses("row", 32));
    EXPECT_GE(misses("hilbert", 32), misses("hilbert", 16));
}

TEST(CacheReplay, EachMachineHasItsOwnMisses) {
    const CacheTrace trace = plane(8, 4, 2);
    const auto order = orderOf("hilbert", 8);
    const CacheReplay two = replayCaches(trace, order, {trace.workingSet(), 1, 2});
    EXPECT_GT(two.misses, 32u * 32u);
    EXPECT_GE(two.mostMisses, two.misses / 2);
    EXPECT_LT(two.mostMisses, two.misses);
    EXPECT_EQ(two.looks, replayCaches(trace, order, {100, 1, 1}).looks);
}

TEST(CacheReplay, ThreadsShareOne) {
    const CacheTrace trace = plane(8, 4, 2);
    const CacheReplay two = replayCaches(trace, orderOf("hilbert", 8), {trace.workingSet(), 2, 1});
    EXPECT_EQ(two.misses, 32u * 32u);
}

TEST(CacheReplay, LooksAreOfTheirUsers) {
    TraceWatch watch(1);
    watch.begin(0);
    watch.asked({0, 1, 10, false, CacheUser::kGather});
    watch.asked({1, 1, 30, false, CacheUser::kCamera});
    watch.asked({0, 1, 10, false, CacheUser::kShadow});  // one of the last few
    const CacheTrace trace = watch.take();
    ASSERT_EQ(trace.buckets[0].size(), 2u);
    const std::vector<std::uint32_t> order{0};
    const CacheReplay replay = replayCaches(trace, order, {1000, 1, 1});
    EXPECT_EQ(replay.missesOf[static_cast<std::size_t>(CacheUser::kGather)], 1u);
    EXPECT_EQ(replay.missesOf[static_cast<std::size_t>(CacheUser::kCamera)], 1u);
    EXPECT_EQ(replay.bytes, 40u);
}

TEST(CacheReplay, OneCacheMayStayUntraced) {
    TraceWatch watch(1, 1);
    watch.begin(0);
    watch.asked({0, 1, 10, true, CacheUser::kGather});
    watch.asked({1, 1, 30, true, CacheUser::kGather});
    EXPECT_EQ(watch.take().workingSet(), 10u);
}

// One value fits; two are asked for by turns.
TEST(CacheReplay, ABatchedBucketAsksForEachValueOnce) {
    CacheTrace trace{{10, 10}, {{{0, 0}, {1, 0}, {0, 0}, {1, 0}}, {{1, 0}, {0, 0}}}};
    const std::vector<std::uint32_t> order{0, 1};
    EXPECT_EQ(replayCaches(trace, order, {10, 1, 1}).misses, 5u);
    const CacheTrace once = batched(trace);
    EXPECT_EQ(once.buckets[0].size(), 2u);
    EXPECT_EQ(once.buckets[1].size(), 2u);
    EXPECT_EQ(replayCaches(once, order, {10, 1, 1}).misses, 3u);
}

TEST(CacheReplay, CoarserValuesAreTheirUsersOwn) {
    constexpr auto gather = static_cast<std::uint32_t>(CacheUser::kGather) & 0xfu;
    const CacheTrace trace{{32, 16}, {{{0, 0}, {0, gather}, {1, gather}}}};
    const std::vector<std::uint32_t> order{0};
    EXPECT_EQ(replayCaches(trace, order, {1000, 1, 1}).bytes, 48u);
    const std::array<CacheUser, 1> users{CacheUser::kGather};
    const CacheReplay coarse = replayCaches(coarsened(trace, users, 4), order, {1000, 1, 1});
    EXPECT_EQ(coarse.misses, 3u);
    EXPECT_EQ(coarse.bytes, 32u + 8u + 4u);
}

}  // namespace
}  // namespace pm::bench
