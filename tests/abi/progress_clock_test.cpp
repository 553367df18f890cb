// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// How far a render is, whatever is to end it.
#include "plugin/session/progress_clock.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

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

// 10 seconds a pass, all of them buckets.
struct Passes {
    double seconds = 0;
    std::uint32_t pass = 0;
    std::optional<double> errorPasses{};
    ProgressClock clock;
    explicit Passes(const ProgressClock::Ends& ends)
        : clock(ends, false, [this] { return seconds; }) {}
    ProgressClock::Reading at(double passes) {
        while (pass + 1 <= passes) {
            seconds = 10 * ++pass;
            clock.endPass(0, 10, errorPasses);
        }
        seconds = 10 * passes;
        return clock.buckets(pass, passes - pass);
    }
};

TEST(ProgressClock, RemainingIsWhatPassesTake) {
    Passes passes({8, {}, {}});
    EXPECT_NEAR(75.0, passes.at(0.5).remainingSeconds, 1e-9);
    EXPECT_NEAR(20.0, passes.at(6).remainingSeconds, 1e-9);
    EXPECT_NEAR(5.0, passes.at(7.5).remainingSeconds, 1e-9);
}

TEST(ProgressClock, RemainingIsAbsentInTheFirstTwoSeconds) {
    for (const ProgressClock::Ends& ends :
         {ProgressClock::Ends{8, {}, {}}, ProgressClock::Ends{{}, 100, {}},
          ProgressClock::Ends{{}, {}, 8}}) {
        Passes passes(ends);
        EXPECT_TRUE(std::isnan(passes.at(0.1).remainingSeconds));
        EXPECT_TRUE(std::isnan(passes.at(0.199).remainingSeconds));
        EXPECT_FALSE(std::isnan(passes.at(0.2).remainingSeconds));
    }
}

// No pass is begun that wouldn't fit, and one is made in any case.
TEST(ProgressClock, TheTimeLimitCountsWhereItEndsFirst) {
    Passes passes({8, 40, {}});
    EXPECT_NEAR(0.25, passes.at(1).fraction, 1e-9);
    EXPECT_NEAR(30.0, passes.at(1).remainingSeconds, 1e-9);
    Passes odd({8, 47, {}});
    EXPECT_NEAR(30.0, odd.at(1).remainingSeconds, 1e-9);
    Passes more({2, 400, {}});
    EXPECT_NEAR(0.5, more.at(1).fraction, 1e-9);
    EXPECT_NEAR(10.0, more.at(1).remainingSeconds, 1e-9);
    Passes tight({8, 5, {}});
    EXPECT_NEAR(6.0, tight.at(0.4).remainingSeconds, 1e-9);
    EXPECT_LT(tight.at(0.9).fraction, 1.0);
}

TEST(ProgressClock, AnErrorTargetIsForeseen) {
    Passes passes({});
    EXPECT_EQ(0.0, passes.at(0.5).fraction);
    EXPECT_TRUE(std::isnan(passes.at(0.5).remainingSeconds));
    passes.errorPasses = 8.0;
    EXPECT_NEAR(0.25, passes.at(2).fraction, 1e-9);
    EXPECT_NEAR(60.0, passes.at(2).remainingSeconds, 1e-9);
    // It turns out to lie further: the fraction stays, the remaining time tells.
    passes.errorPasses = 29.5;
    EXPECT_NEAR(0.25, passes.at(3).fraction, 1e-9);
    EXPECT_NEAR(270.0, passes.at(3).remainingSeconds, 1e-9);
    // And nearer than it was thought: not done before it is, and not before the end of a pass.
    passes.errorPasses = 4.0;
    EXPECT_NEAR(0.99, passes.at(4.5).fraction, 1e-9);
    EXPECT_NEAR(5.0, passes.at(4.5).remainingSeconds, 1e-9);
}

// A render as it goes on: photons, then buckets, passes of unlike costs.
struct Course {
    double now = 0;
    double photonSeconds = 3, bucketSeconds = 7;
    double growth = 1;          // of the buckets from the second pass on
    std::uint32_t resumed = 0;  // passes
    double share = 0;           // and of the next
    std::uint32_t passes = 6;

    double bucketsOf(std::uint32_t pass) const {
        return pass < 1 ? bucketSeconds : growth * bucketSeconds;
    }
    double length() const {
        double seconds = 0;
        for (std::uint32_t pass = resumed; pass < passes; ++pass)
            seconds += photonSeconds + bucketsOf(pass) * (pass == resumed ? 1 - share : 1);
        return seconds;
    }
    // look(reading, true remaining seconds) again and again.
    template <typename Look>
    void run(ProgressClock& clock, Look&& look) {
        constexpr int kSteps = 50;
        const double end = length();
        const auto hasPhotons = photonSeconds > 0;
        clock.startAt(resumed, share);
        for (std::uint32_t pass = resumed; pass < passes; ++pass) {
            const double from = pass == resumed ? share : 0;
            for (int i = 1; hasPhotons && i <= kSteps; ++i) {
                now += photonSeconds / kSteps;
                look(clock.photons(pass, static_cast<double>(i) / kSteps), end - now);
            }
            clock.buckets(pass, from);
            for (int i = 1; i <= kSteps; ++i) {
                now += bucketsOf(pass) * (1 - from) / kSteps;
                look(clock.buckets(pass, from + (1 - from) * i / kSteps), end - now);
            }
            clock.endPass(photonSeconds, bucketsOf(pass) * (1 - from), {},
                          pass == 0 ? growth : 1.0);
        }
    }
};

// What costs always the same is known as soon as each phase was seen once; before, the guess
// counts.
TEST(ProgressClock, RemainingIsRightOnceAPassIsKnown) {
    for (const double share : {0.0, 0.6})
        for (const std::uint32_t resumed : {0u, 3u})
            for (const double photons : {0.0, 1.0, 20.0}) {
                Course course;
                course.photonSeconds = photons;
                course.resumed = resumed;
                course.share = share;
                ProgressClock clock({6, {}, {}}, photons > 0, [&] { return course.now; });
                const double firstPass = photons + course.bucketSeconds * (1 - share);
                int known = 0;
                course.run(clock, [&](const ProgressClock::Reading& reading, double truth) {
                    if (course.now < firstPass || course.now < 2) return;
                    ++known;
                    ASSERT_NEAR(truth, reading.remainingSeconds, 1e-6) << course.now;
                });
                EXPECT_GE(known, 100);
            }
}

TEST(ProgressClock, AdaptivePassesAreForeseen) {
    Course course;
    course.growth = 3;
    ProgressClock clock({6, {}, {}, 2.5}, true, [&] { return course.now; });
    course.run(clock, [&](const ProgressClock::Reading& reading, double truth) {
        if (course.now < 2) return;
        // By the guess at first, exactly once the second pass's samples are allotted.
        const bool isAllotted = course.now > 10.01;
        EXPECT_NEAR(truth, reading.remainingSeconds, isAllotted ? 1e-6 : 0.25 * truth)
            << course.now;
    });
}

// Whatever happens: the fraction rises from 0 to at most 1, remaining times are numbers from 0 on.
TEST(ProgressClock, HoldsItsPromisesWhateverHappens) {
    std::mt19937 random(7);
    const auto uniform = [&](double lo, double hi) {
        return std::uniform_real_distribution(lo, hi)(random);
    };
    const auto maybe = [&](double lo, double hi) {
        return random() % 2 == 0 ? std::optional<double>() : uniform(lo, hi);
    };
    for (int i = 0; i < 500; ++i) {
        double now = 0;
        const bool hasPhotons = random() % 3 > 0;
        const auto passes = static_cast<std::uint32_t>(1 + random() % 8);
        ProgressClock::Ends ends{maybe(1, 10), maybe(0.1, 100), {}, uniform(0.5, 4)};
        if (ends.passes) ends.passes = passes;
        ProgressClock clock(ends, hasPhotons, [&] { return now; });
        const auto resumed = static_cast<std::uint32_t>(random() % 3);
        clock.startAt(resumed, random() % 2 == 0 ? 0.0 : uniform(0, 0.999));
        double fraction = 0;
        const auto look = [&](const ProgressClock::Reading& reading) {
            ASSERT_GE(reading.fraction, fraction);
            ASSERT_LE(reading.fraction, 1.0);
            fraction = reading.fraction;
            if (now < 2) {
                ASSERT_TRUE(std::isnan(reading.remainingSeconds));
            }
            if (std::isnan(reading.remainingSeconds)) return;
            ASSERT_GE(reading.remainingSeconds, 0.0);
            ASSERT_TRUE(std::isfinite(reading.remainingSeconds));
        };
        for (std::uint32_t pass = resumed; pass < passes; ++pass) {
            const double start = now;
            for (int step = 0; hasPhotons && step < 10; ++step) {
                now += uniform(0, 1) < 0.2 ? 0 : uniform(0, 3);
                look(clock.photons(pass, uniform(-0.1, 1.1)));  // pilots begin anew
            }
            const double between = now;
            for (int step = 0; step < 10; ++step) {
                now += uniform(0, 1) < 0.2 ? 0 : uniform(0, 3);
                look(clock.buckets(pass, uniform(0, 1)));  // workers overtake each other
            }
            clock.endPass(between - start, now - between, maybe(0, 20), uniform(0, 5));
        }
        if (ends.passes && resumed < passes) {
            look(clock.buckets(passes - 1, 1.0));
            EXPECT_EQ(1.0, fraction);
        }
    }
}

}  // namespace

}  // namespace pm::plugin
