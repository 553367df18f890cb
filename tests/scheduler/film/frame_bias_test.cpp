// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// The bias of a frame's density estimates told without a reference, on pictures whose truth is
// known.
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "tests/scheduler/film/error_frame.h"

namespace pm::test {
namespace {

// Of a disc's area, what lies beyond a line that is `t` radii from its middle.
float beyond(float t) {
    if (t >= 1.0f) return 0.0f;
    return (std::acos(t) - t * std::sqrt(1.0f - t * t)) / 3.14159265f;
}

// Light of 0.5 on the left and 1 on the right, blurred by a disc of `radius` pixels, and a probe
// that shows the same blurred by a disc narrower by sqrt(2); both noisy.
Rendered renderEdge(float radius, float noise, int passes, unsigned seed) {
    Random random(seed);
    std::normal_distribution<float> normal;
    FrameStore frame(kFrame, kChannels, 0, 3);
    std::vector<float> truth(kPixels);
    const std::vector<float> weights(kPixels, 4.0f);
    for (std::uint32_t pass = 0; pass < static_cast<std::uint32_t>(passes); ++pass) {
        std::vector<float> pixels(kPixels * kChannels);
        for (std::size_t i = 0; i < pixels.size(); ++i) {
            const float x = static_cast<float>(i / kChannels % kSize) + 0.5f - 0.5f * kSize;
            const float side = x < 0 ? 0.5f : -0.5f, t = std::abs(x) / radius;
            truth[i / kChannels] = x < 0 ? 0.5f : 1.0f;
            const float wide = side * beyond(t), narrow = side * beyond(std::sqrt(2.0f) * t);
            const float mean = i % kChannels < 3 ? truth[i / kChannels] + wide : narrow - wide;
            pixels[i] = mean + noise * normal(random);
        }
        frame.addPass(pass, kFrame, pixels, weights);
    }
    return {frame.estimateError().value(), relMseOf(frame, truth)};
}

TEST(FrameBias, biasOfABlurredEdgeIsToldFromTheProbe) {
    for (const int passes : {2, 4, 16}) {
        // 8 over 13.2, and the denominator is of the blurred picture: on the dark side too large.
        const Rendered sure = renderEdge(12.0f, 0.01f, passes, 3);
        EXPECT_NEAR(sure.estimate.bias / sure.relMse, 0.53, 0.05) << passes;
        const Rendered noisy = renderEdge(12.0f, 0.1f, passes, 3);
        EXPECT_NEAR(noisy.estimate.total() / noisy.relMse, 0.75, 0.3) << passes;
    }
    // Noise alone would be far from the truth.
    const Rendered late = renderEdge(12.0f, 0.1f, 16, 3);
    EXPECT_LT(late.estimate.noise, late.relMse / 3);
}

// A picture that is `bias` too bright, and a probe that shows minus half of it; both noisy.
Rendered renderBiased(float bias, float noise, int passes, unsigned seed) {
    Random random(seed);
    std::normal_distribution<float> normal;
    FrameStore frame(kFrame, kChannels, 0, 3);
    const std::vector<float> truth(kPixels, 1.0f), weights(kPixels, 4.0f);
    for (std::uint32_t pass = 0; pass < static_cast<std::uint32_t>(passes); ++pass) {
        std::vector<float> pixels(kPixels * kChannels);
        for (std::size_t i = 0; i < pixels.size(); ++i) {
            const float mean = i % kChannels < 3 ? 1.0f + bias : -0.5f * bias;
            pixels[i] = mean + noise * normal(random);
        }
        frame.addPass(pass, kFrame, pixels, weights);
    }
    return {frame.estimateError().value(), relMseOf(frame, truth)};
}

TEST(FrameBias, biasOfSmoothLightIsToldToAFactorOfTwo) {
    for (const int passes : {2, 3, 4, 16}) {
        const Rendered b = renderBiased(0.05f, 0.1f, passes, 3);
        EXPECT_NEAR(b.estimate.bias, 2 * 0.05 * 0.05 / 1.1125, 4 * *b.estimate.biasStandardError);
        EXPECT_LT(*b.estimate.biasStandardError, 0.5 * b.estimate.bias) << passes;
        EXPECT_GT(b.estimate.total(), 0.9 * b.relMse) << passes;
        EXPECT_LT(b.estimate.total(), 2.2 * b.relMse) << passes;
    }
}

// Beside light as even as it seems, a line that is half as bright again by a narrower radius.
TEST(FrameBias, whatTheNarrowerRadiusCantResolveMakesItALowerBound) {
    for (const float change : {0.0f, 0.1f, 0.45f}) {
        Random random(9);
        std::normal_distribution<float> normal;
        FrameStore frame(kFrame, kChannels, 0, 3);
        for (std::uint32_t pass = 0; pass < 4; ++pass) {
            std::vector<float> pixels(kPixels * kChannels);
            for (std::size_t i = 0; i < pixels.size(); ++i) {
                const bool onLine = i / kChannels % kSize == 20;
                const float mean = i % kChannels < 3 ? 1.0f : onLine ? change : 0.0f;
                pixels[i] = mean + 0.05f * normal(random);
            }
            frame.addPass(pass, kFrame, pixels, std::vector<float>(kPixels, 4.0f));
        }
        const FrameError error = frame.estimateError().value();
        const bool isUnresolved = change > 0.3f;
        EXPECT_EQ(error.isLowerBound(), isUnresolved);
        EXPECT_DOUBLE_EQ(error.unresolvedShare, isUnresolved ? 1.0 / kSize : 0.0);
    }
}

TEST(FrameBias, noiseOfTheProbeIsNoBias) {
    double sum = 0, squares = 0;
    constexpr int kRenders = 40;
    for (unsigned seed = 0; seed < kRenders; ++seed) {
        const FrameError error = renderBiased(0.0f, 0.2f, 4, seed).estimate;
        const double z = error.bias / *error.biasStandardError;
        sum += z / kRenders;
        squares += z * z / kRenders;
        EXPECT_GE(error.total(), error.noise);
        // Its probe is as noisy as the picture: five times 8 * 2 / sqrt(12288).
        EXPECT_LT(error.total(), 1.7 * error.noise);
    }
    EXPECT_LT(std::abs(sum), 4 / std::sqrt(kRenders));
    EXPECT_NEAR(squares, 1.0, 0.9);  // of 4 squares' spread
}

}  // namespace
}  // namespace pm::test
