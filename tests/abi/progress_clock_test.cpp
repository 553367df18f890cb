// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// How far a render is, whatever is to end it.
#include "plugin/src/progress_clock.h"

#include <gtest/gtest.h>

#include <cmath>

namespace pm::plugin {

namespace {

TEST(ProgressClock, NeverFallsAndLearnsTheShare) {
    ProgressClock clock({2, {}, {}}, true);
    const double first = clock.photons(0, 1.0).fraction;
    EXPECT_NEAR(0.15, first, 1e-12);
    EXPECT_TRUE(std::isnan(clock.buckets(0, 0.5).remainingSeconds));
    EXPECT_NEAR(0.5, clock.buckets(0, 1.0).fraction, 1e-12);
    clock.endPass(9.0, 1.0, {});
    EXPECT_NEAR(0.95, clock.photons(1, 1.0).fraction, 1e-12);
    EXPECT_NEAR(0.95, clock.photons(0, 0.0).fraction, 1e-12);
    EXPECT_NEAR(1.0, clock.buckets(1, 1.0).fraction, 1e-12);
}

// 10 seconds a pass.
struct Passes {
    double seconds = 0;
    ProgressClock clock;
    explicit Passes(const ProgressClock::Ends& ends)
        : clock(ends, false, [this] { return seconds; }) {}
    ProgressClock::Reading at(double passes) {
        seconds = 10 * passes;
        return clock.buckets(static_cast<std::uint32_t>(passes), passes - std::floor(passes));
    }
};

TEST(ProgressClock, RemainingIsWhatPassesTake) {
    Passes passes({8, {}, {}});
    EXPECT_NEAR(75.0, passes.at(0.5).remainingSeconds, 1e-9);
    EXPECT_NEAR(20.0, passes.at(6).remainingSeconds, 1e-9);
}

TEST(ProgressClock, TheTimeLimitCountsWhereItEndsFirst) {
    Passes passes({8, 40, {}});
    EXPECT_NEAR(0.25, passes.at(1).fraction, 1e-9);
    EXPECT_NEAR(30.0, passes.at(1).remainingSeconds, 1e-9);
    Passes more({2, 400, {}});
    EXPECT_NEAR(0.5, more.at(1).fraction, 1e-9);
    EXPECT_NEAR(10.0, more.at(1).remainingSeconds, 1e-9);
}

TEST(ProgressClock, AnErrorTargetIsForeseen) {
    Passes passes({});
    EXPECT_EQ(0.0, passes.at(1.5).fraction);
    EXPECT_TRUE(std::isnan(passes.at(1.5).remainingSeconds));
    passes.clock.endPass(0, 10, 8.0);
    EXPECT_NEAR(0.25, passes.at(2).fraction, 1e-9);
    EXPECT_NEAR(60.0, passes.at(2).remainingSeconds, 1e-9);
    // It turns out to lie further: the fraction stays, the remaining time tells.
    passes.clock.endPass(0, 10, 30.0);
    EXPECT_NEAR(0.25, passes.at(3).fraction, 1e-9);
    EXPECT_NEAR(270.0, passes.at(3).remainingSeconds, 1e-9);
    // And nearer than it was thought: not done before it is.
    passes.clock.endPass(0, 10, 4.0);
    EXPECT_NEAR(0.99, passes.at(4.5).fraction, 1e-9);
    EXPECT_NEAR(0.0, passes.at(4.5).remainingSeconds, 1e-9);
}

}  // namespace

}  // namespace pm::plugin
