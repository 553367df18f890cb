// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// The error of a frame that comes bucket by bucket, against that of the whole frame.
#include "scheduler/film/bucket_errors.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace pm {
namespace {

constexpr Rect kFrame{0, 0, 96, 64};
constexpr std::int32_t kChannels = 6, kProbe = 3;  // beauty, then probe
constexpr std::uint32_t kPasses = 4;

// What the passes give the pixels of a rectangle: the same for a pixel in any. Here and there a
// firefly, so that the trimmed figure has something to leave out.
FrameStore rendered(const Rect& rect, float badPixel = 0.0f) {
    FrameStore store(rect, kChannels, 0, kProbe);
    for (std::uint32_t pass = 0; pass < kPasses; ++pass) {
        std::vector<float> pixels;
        for (std::int32_t y = rect.y0; y < rect.y1; ++y)
            for (std::int32_t x = rect.x0; x < rect.x1; ++x) {
                std::minstd_rand random(static_cast<unsigned>((y * 1000 + x) * 10 + 7919) + pass);
                random.discard(3);
                std::normal_distribution<float> normal;
                const float truth = x < 48 ? 0.1f : 1.0f;
                const bool firefly = (x * 7 + y * 13) % 601 == 0 && pass == 1;
                for (int c = 0; c < 3; ++c)
                    pixels.push_back(truth * (1 + 0.3f * normal(random)) + (firefly ? 20.0f : 0));
                for (int c = 0; c < 3; ++c)
                    pixels.push_back(0.05f * truth * (1 + 0.1f * normal(random)));
                if (x == 50 && y == 20) pixels.back() += badPixel;
            }
        store.addPass(pass, rect, pixels,
                      std::vector<float>(static_cast<std::size_t>(rect.area()), 4.0f));
    }
    return store;
}

FrameError byBuckets(std::int32_t size, bool backwards) {
    const BucketGrid grid(kFrame, size);
    BucketErrors errors(grid);
    EXPECT_FALSE(errors.result());
    for (std::uint32_t i = 0; i < grid.cellCount(); ++i) {
        const std::uint32_t cell = backwards ? grid.cellCount() - 1 - i : i;
        errors.add(cell, rendered(grid.cellRect(cell)));
    }
    return errors.result().value();
}

void expectNear(double wanted, double found, double tolerance) {
    EXPECT_NEAR(1.0, found / wanted, tolerance) << found << " for " << wanted;
}

TEST(BucketErrors, OneBucketIsTheWholeFrame) {
    const FrameError whole = rendered(kFrame).estimateError().value();
    const FrameError bucket = byBuckets(96, false);
    // Both are sums of 6144 pixels in other orders.
    constexpr double kRounding = 1e-11;
    expectNear(whole.noise, bucket.noise, kRounding);
    expectNear(whole.noiseTrimmed, bucket.noiseTrimmed, kRounding);
    expectNear(whole.bias, bucket.bias, kRounding);
    expectNear(whole.biasStandardError.value(), bucket.biasStandardError.value(), kRounding);
    EXPECT_LT(whole.noiseTrimmed, 0.5 * whole.noise);  // there were fireflies to leave out
}

TEST(BucketErrors, KnowsNoOrder) {
    for (const std::int32_t size : {8, 40}) {
        const FrameError forwards = byBuckets(size, false), backwards = byBuckets(size, true);
        EXPECT_EQ(forwards.noise, backwards.noise);
        EXPECT_EQ(forwards.noiseTrimmed, backwards.noiseTrimmed);
        EXPECT_EQ(forwards.bias, backwards.bias);
        EXPECT_EQ(forwards.biasStandardError, backwards.biasStandardError);
    }
}

// A pixel at a border has fewer neighbours: of buckets of 32 pixels 6 % of the pixels.
TEST(BucketErrors, IsNearThatOfTheWhole) {
    const FrameError whole = rendered(kFrame).estimateError().value();
    const FrameError buckets = byBuckets(32, false);
    expectNear(whole.noise, buckets.noise, 0.1);
    expectNear(whole.noiseTrimmed, buckets.noiseTrimmed, 0.1);
    expectNear(whole.bias, buckets.bias, 0.05);
    expectNear(whole.biasStandardError.value(), buckets.biasStandardError.value(), 0.25);
}

TEST(BucketErrors, ABadValueStaysVisible) {
    const BucketGrid grid(kFrame, 96);
    BucketErrors errors(grid);
    errors.add(0, rendered(kFrame, std::numeric_limits<float>::quiet_NaN()));
    EXPECT_TRUE(std::isnan(errors.result().value().bias));
}

}  // namespace
}  // namespace pm
