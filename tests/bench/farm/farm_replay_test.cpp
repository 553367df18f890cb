// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// The replay of farms, on costs whose time is known.
#include "tests/bench/farm/farm_replay.h"

#include <gtest/gtest.h>

#include <stdexcept>

#include "host_shim/farm/job/run_cut.h"

namespace pm::bench {
namespace {

// So many buckets of a second each, and nothing besides.
FarmCosts plain(std::size_t buckets) {
    FarmCosts costs;
    costs.buckets.assign(buckets, 1.0);
    costs.pilot = costs.buckets;
    return costs;
}

FarmRules rulesOf(int workers, int runs) {
    FarmRules rules;
    rules.workers = workers;
    rules.runs = runs;
    return rules;
}

double secondsOf(const FarmCosts& costs, const FarmRules& rules) {
    return replayFarm(costs, rules).seconds;
}

TEST(FarmReplay, WorkIsShared) {
    const FarmCosts costs = plain(64);
    for (const int workers : {1, 2, 4, 64})
        EXPECT_NEAR(secondsOf(costs, rulesOf(workers, 64)), 64.0 / workers, 1e-6) << workers;
    EXPECT_NEAR(secondsOf(costs, rulesOf(128, 128)), 1, 1e-6) << "a bucket each";
    const FarmReplay three = replayFarm(costs, rulesOf(3, 4));
    EXPECT_NEAR(three.seconds, 32, 1e-6) << "one has two runs";
    EXPECT_NEAR(three.lastWaits, 2.0 / 3 * 16, 1e-6);
    EXPECT_NEAR(efficiencyOf(costs, three, 3), 64.0 / 96, 1e-6);
}

TEST(FarmReplay, RunsAreThoseOfTheFarm) {
    FarmCosts costs = plain(2000);
    EXPECT_EQ(replayFarm(costs, rulesOf(8, 0)).runs, host::runCount({2000, 0}, 1, 8));
    // The pilot saw that the first quarter costs as much as the others together; it does not.
    for (std::size_t i = 0; i < 500; ++i) costs.pilot[i] = 3;
    EXPECT_NEAR(secondsOf(costs, rulesOf(2, 2)), 1500, 2);
}

TEST(FarmReplay, WhatEachRunCostsIsPaidByEachRun) {
    FarmCosts costs = plain(8);
    costs.startSeconds = 2;
    costs.mapSeconds = 3;
    EXPECT_NEAR(secondsOf(costs, rulesOf(1, 4)), 8 + 4 * 5, 1e-6);
    costs.photonSeconds = 10;
    FarmRules rules = rulesOf(1, 4);
    EXPECT_NEAR(secondsOf(costs, rules), 12 + 8 + 4 * 5, 1e-6) << "traced by a process of its own";
    rules.photonsOnce = false;
    EXPECT_NEAR(secondsOf(costs, rules), 8 + 4 * 15, 1e-6);
}

TEST(FarmReplay, LatenciesAddUp) {
    FarmCosts costs = plain(8);
    costs.pilotSeconds = 0.5;
    costs.mergeSeconds = 0.25;
    costs.photonSeconds = 1;
    FarmRules rules = rulesOf(2, 8);
    rules.submitSeconds = 1;
    rules.afterPhotons = 2;
    rules.dispatchSeconds = 0.125;
    rules.noticeSeconds = 4;
    EXPECT_NEAR(secondsOf(costs, rules), 0.5 + 1 + 1 + 2 + 4 + 3 * 0.125 + 4 + 0.25, 1e-6);
}

TEST(FarmReplay, TheServerIsShared) {
    FarmCosts costs = plain(4);
    costs.sceneBytes = 100;
    FarmRules rules = rulesOf(4, 4);
    rules.serverRate = 100;
    EXPECT_NEAR(secondsOf(costs, rules), 4 + 1, 1e-6);
    rules.serverRate = 1000;
    rules.linkRate = 50;
    EXPECT_NEAR(secondsOf(costs, rules), 2 + 1, 1e-6);
    costs.partBytes = 100;  // to the server, and from there once more
    EXPECT_NEAR(secondsOf(costs, rules), 2 + 1 + 0.5 + 2, 1e-6);
}

TEST(FarmReplay, CoresAreShared) {
    FarmRules rules = rulesOf(4, 4);
    rules.cores = 2;
    EXPECT_NEAR(secondsOf(plain(8), rules), 4, 1e-6);
    rules.sharedSpeed = 0.5;
    EXPECT_NEAR(secondsOf(plain(8), rules), 8, 1e-6);
    rules.workers = rules.runs = 1;
    EXPECT_NEAR(secondsOf(plain(8), rules), 8, 1e-6) << "alone it is as fast as ever";
}

TEST(FarmReplay, SlowWorkersGetFewerRuns) {
    FarmRules rules = rulesOf(10, 10);
    rules.slowShare = 0.1;
    rules.slowSpeed = 0.5;
    EXPECT_NEAR(secondsOf(plain(100), rules), 20, 1e-6);
    rules.runs = 100;
    EXPECT_LE(secondsOf(plain(100), rules), 12.0);
}

TEST(FarmReplay, PreemptionLosesStartsAndHalfABucket) {
    FarmCosts costs = plain(10);
    costs.startSeconds = 1;
    FarmRules rules = rulesOf(1, 1);
    costs.mapSeconds = 4;
    costs.passes = 4;
    rules.preemptedEvery = 6;
    rules.dispatchSeconds = 2;
    // 15 s in all; each time the start, a pass's maps and half a bucket's pass are made again.
    const double again = 1 + 1 + 0.125;
    EXPECT_NEAR(secondsOf(costs, rules), 15 + 2 * (2 + again) + (2 + again), 1e-6);
    rules.preemptedEvery = 2;
    EXPECT_THROW(replayFarm(costs, rules), std::logic_error);
}

TEST(FarmReplay, RefusesWhatIsNoFarm) {
    EXPECT_THROW(replayFarm({}, rulesOf(1, 1)), std::logic_error);
    EXPECT_THROW(replayFarm(plain(1), rulesOf(0, 1)), std::logic_error);
}

}  // namespace
}  // namespace pm::bench
