// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// The frame's error told without a reference, on pictures whose truth is known.
#include "scheduler/film/frame_error.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <vector>

#include "scheduler/film/frame_store.h"
#include "tests/scheduler/film/error_frame.h"

namespace pm::test {
namespace {

// What a pass gives a pixel whose truth is `truth`.
using Noise = std::function<float(float truth, Random& random)>;

float gaussian(float truth, Random& random) {
    return truth * (1.0f + 0.3f * std::normal_distribution<float>()(random));
}

// Half of the light comes in one pass of ten.
float fireflies(float truth, Random& random) {
    constexpr float kRarely = 0.1f;
    const bool hit = std::uniform_real_distribution<float>()(random) < kRarely;
    return truth * (hit ? 0.5f / kRarely : 0.5f / (1.0f - kRarely)) +
           0.1f * truth * std::normal_distribution<float>()(random);
}

// Bright and dark halves, steps, a gradient, a fine texture and, if wanted, a line a pixel wide.
std::vector<float> variedTruth(bool line = true) {
    std::vector<float> truth(kPixels);
    for (std::size_t i = 0; i < kPixels; ++i) {
        const std::size_t x = i % kSize, y = i / kSize;
        float value = x < kSize / 2 ? 0.02f : 1.5f;
        if (y < 16) value *= 1.0f + static_cast<float>(x % 2);
        if (y > 40) value *= 0.2f + static_cast<float>(x) / kSize;
        if (line && x == 20 && y > 20) value = 8.0f;
        truth[i] = value;
    }
    return truth;
}

Rendered render(const std::vector<float>& truth, int passes, const Noise& noise, unsigned seed) {
    Random random(seed);
    FrameStore frame(kFrame, kChannels, 0);
    const std::vector<float> weights(kPixels, 4.0f);
    for (std::uint32_t pass = 0; pass < static_cast<std::uint32_t>(passes); ++pass) {
        std::vector<float> pixels(kPixels * kChannels);
        for (std::size_t i = 0; i < kPixels; ++i) {
            for (std::size_t c = 0; c < 3; ++c) pixels[i * kChannels + c] = noise(truth[i], random);
        }
        frame.addPass(pass, kFrame, pixels, weights);
    }
    return {frame.estimateError().value(), relMseOf(frame, truth)};
}

// Over many renders: the mean estimate over the mean truth, and how often one is within a factor of
// 1.5 of the other.
struct Judged {
    double ratio = 0, within = 0;
};

Judged judge(const std::vector<float>& truth, int passes, const Noise& noise) {
    constexpr int kRenders = 20;
    double estimates = 0, truths = 0, within = 0;
    for (unsigned seed = 1; seed <= kRenders; ++seed) {
        const Rendered r = render(truth, passes, noise, seed);
        estimates += r.estimate.total();
        truths += r.relMse;
        const double ratio = r.estimate.total() / r.relMse;
        within += ratio < 1.5 && ratio > 1 / 1.5 ? 1.0 / kRenders : 0.0;
    }
    return {estimates / truths, within};
}

TEST(FrameError, isUnknownWithLessThanTwoPasses) {
    FrameStore frame(kFrame, kChannels, 0, 3);
    EXPECT_FALSE(frame.estimateError());
    const std::vector<float> pixels(kPixels * kChannels), weights(kPixels, 1.0f);
    frame.addPass(0, kFrame, pixels, weights);
    EXPECT_FALSE(frame.estimateError());
    // One pixel with two passes is enough, and is all that is told of.
    frame.addPass(1, {3, 3, 4, 4}, std::span(pixels).first(kChannels), std::span(weights).first(1));
    ASSERT_TRUE(frame.estimateError());
    EXPECT_EQ(frame.estimateError()->total(), 0.0);
    EXPECT_FALSE(frame.estimateError()->biasStandardError);
}

TEST(FrameError, noiseOfAnEvenPictureIsRight) {
    // Both halves' means are a and b: 12288 values of one degree of freedom each, known to 1.3 %.
    for (const float truth : {0.001f, 0.1f, 30.0f}) {
        for (const int passes : {2, 3, 5, 16}) {
            const std::vector<float> even(kPixels, truth);
            const double r = static_cast<double>(truth);
            const double expected = 0.09 * r * r / passes / (r * r + 0.01);
            EXPECT_NEAR(render(even, passes, gaussian, 7).estimate.noise / expected, 1.0, 0.06)
                << truth << ", " << passes;
        }
    }
}

TEST(FrameError, isRightForVariedPicturesAndNoises) {
    for (const int passes : {2, 3, 4, 8, 16}) {
        const Judged light = judge(variedTruth(), passes, gaussian);
        // Of two passes, what stands for the reference is least known.
        EXPECT_NEAR(light.ratio, 1.0, passes == 2 ? 0.15 : 0.1) << passes;
        EXPECT_GE(light.within, 0.9) << passes;
        // Not with the line: bright and wild where all around is dark, it is taken for outliers.
        const Judged heavy = judge(variedTruth(false), passes, fireflies);
        EXPECT_NEAR(heavy.ratio, 1.0, passes == 2 ? 0.4 : 0.25) << passes;
        EXPECT_GE(heavy.within, 0.9) << passes;
    }
}

// Lone pixels that came out a thousand times too bright: their error must show, which it does not
// when it is divided by their own square.
TEST(FrameError, seesLoneOutliers) {
    FrameStore frame(kFrame, 3, 0);
    const std::vector<float> weights(kPixels, 1.0f);
    for (std::uint32_t pass = 0; pass < 4; ++pass) {
        std::vector<float> pixels(3 * kPixels, 1.0f);
        for (const std::size_t outlier : {700u, 701u, 0u, 4095u})
            for (std::size_t c = 0; pass == 2 && c < 3; ++c) pixels[3 * outlier + c] = 1001.0f;
        frame.addPass(pass, kFrame, pixels, weights);
    }
    const double expected = 4 * 250.0 * 250.0 / 1.01 / kPixels;
    // Two of them are neighbours: the mean beside an outlier is raised by 250/8.
    const double noise = frame.estimateError()->noise;
    EXPECT_GT(noise, expected / 4);
    EXPECT_LT(noise, expected * 1.01);
    // Four pixels in 4096 are fewer than one in a thousand (rounded up): nothing else differs.
    EXPECT_EQ(frame.estimateError()->noiseTrimmed, 0.0);
}

// A lone pixel that sees a tiny lamp in one pass of four: its relative error is about 1 where that
// was to be expected and more where it was luck, but not ten million.
TEST(FrameError, aTinyLampThatIsSeenIsNoOutlier) {
    const std::vector<float> weights(kPixels, 1.0f);
    double noise[2] = {};
    for (const std::int32_t emission : {-1, 3}) {
        FrameStore frame(kFrame, 6, 0, -1, emission);
        for (std::uint32_t pass = 0; pass < 4; ++pass) {
            std::vector<float> pixels(6 * kPixels);
            for (std::size_t c = 0; c < 6; ++c) pixels[6 * 900 + c] = pass == 1 ? 4000.0f : 0.0f;
            frame.addPass(pass, kFrame, pixels, weights);
        }
        noise[emission < 0 ? 0 : 1] = frame.estimateError()->noise;
    }
    EXPECT_NEAR(noise[0] * kPixels, 1000.0 * 1000.0 / 0.01, 1e3);
    // Mean of 1 / (x^2 + 1e-8) over the density x exp(-x): -Euler's constant - log(1e-4).
    EXPECT_NEAR(noise[1] * kPixels, 8.633, 0.05);
}

// Integrals of the Gamma density by a fine rule, against the class.
TEST(SeldomLight, isTheMeanOverWhatTheTruthMayBe) {
    for (const double seen : {1.0, 2.5, 10.0, 25.0}) {
        const double lamp = 0.7, rest = 0.2, offset = 0.01;
        double sum = 0, weights = 0;
        for (double x = 0.5e-3; x < 100; x += 1e-3) {
            const double weight = std::exp(seen * std::log(x) - x);
            const double truth = rest + lamp * x / seen;
            sum += weight / (truth * truth + offset);
            weights += weight;
        }
        const SeldomLight light(lamp * lamp, lamp * lamp / seen);
        EXPECT_NEAR(light.meanInverse(lamp, rest, offset) * weights / sum, 1.0, 1e-4) << seen;
    }
    // Many samples: the mean is as good as the truth; and never fewer than one.
    EXPECT_DOUBLE_EQ(SeldomLight(100.0, 1.0).meanInverse(3.0, 1.0, 0.0), 1.0 / 16.0);
    EXPECT_DOUBLE_EQ(SeldomLight(1.0, 9.0).meanInverse(3.0, 1.0, 0.0),
                     SeldomLight(1.0, 1.0).meanInverse(3.0, 1.0, 0.0));
}

TEST(FrameError, trimmedLeavesOutOneInAThousand) {
    const std::vector<float> even(kPixels, 1.0f);
    const FrameError error = render(even, 4, gaussian, 3).estimate;
    EXPECT_LT(error.noiseTrimmed, error.noise);
    EXPECT_GT(error.noiseTrimmed, 0.98 * error.noise);
    // All pixels alike: as many of the equal ones stay as must.
    FrameErrorSum sum({0, 0, 50, 50});
    for (int i = 0; i < 2500; ++i) sum.add(i % 50, i / 50, {3.0, 0.0, false});
    EXPECT_DOUBLE_EQ(sum.result()->noise, 1.0);
    EXPECT_DOUBLE_EQ(sum.result()->noiseTrimmed, (2500.0 - 3.0) / 2500.0);
}

// What samples of a pass share, its photons, their spread does not show: the naive figure misses
// the truth by far, the one between passes does not.
TEST(FrameError, spreadOfSamplesMissesWhatTheyShare) {
    constexpr int kPasses = 4, kSamples = 16;
    Random random(11);
    std::normal_distribution<float> normal;
    FrameStore frame(kFrame, 3, 0);
    const std::vector<float> truth(kPixels, 1.0f), weights(kPixels, kSamples);
    std::vector<double> sums(3 * kPixels), squares(3 * kPixels);
    for (std::uint32_t pass = 0; pass < kPasses; ++pass) {
        std::vector<float> pixels(3 * kPixels);
        for (std::size_t i = 0; i < pixels.size(); ++i) {
            const float shared = 0.3f * normal(random);
            for (int s = 0; s < kSamples; ++s) {
                const float sample = truth[i / 3] + shared + 0.2f * normal(random);
                pixels[i] += sample / kSamples;
                sums[i] += static_cast<double>(sample);
                squares[i] += static_cast<double>(sample) * static_cast<double>(sample);
            }
        }
        frame.addPass(pass, kFrame, pixels, weights);
    }
    double naive = 0;
    constexpr double kAll = kPasses * kSamples;
    for (std::size_t i = 0; i < sums.size(); ++i) {
        const double variance = (squares[i] - sums[i] * sums[i] / kAll) / (kAll - 1);
        naive += variance / kAll / 1.01 / static_cast<double>(sums.size());
    }
    const double relMse = relMseOf(frame, truth);
    EXPECT_LT(naive, relMse / 5);
    EXPECT_NEAR(frame.estimateError()->total() / relMse, 1.0, 0.1);
}

// Even passes that make up for each other, as do parts of one low-discrepancy sequence: the spread
// between passes is then no measure of the mean's error, what the halves differ by is.
TEST(FrameError, halvesAreRightWherePassesOfAHalfAreNotIndependent) {
    Random random(5);
    std::normal_distribution<float> normal;
    FrameStore frame(kFrame, 3, 0);
    const std::vector<float> truth(kPixels, 1.0f), weights(kPixels, 4.0f);
    std::vector<float> swing(3 * kPixels);
    for (std::uint32_t pass = 0; pass < 8; ++pass) {
        std::vector<float> pixels(3 * kPixels);
        for (std::size_t i = 0; i < pixels.size(); ++i) {
            // Passes 0 and 2 swing to opposite sides, so do 4 and 6.
            if (pass % 4 == 0) swing[i] = 0.5f * normal(random);
            const float side = pass % 2 == 1 ? 0.0f : pass % 4 == 0 ? 1.0f : -1.0f;
            pixels[i] = 1.0f + side * swing[i] + 0.1f * normal(random);
        }
        frame.addPass(pass, kFrame, pixels, weights);
    }
    double between = 0;
    for (std::int32_t x = 0; x < kSize; ++x) {
        const double error = static_cast<double>(frame.standardError(x, 20).value()[0]);
        between += error * error / 1.01 / kSize;
    }
    EXPECT_GT(between, 3 * relMseOf(frame, truth));
    EXPECT_NEAR(frame.estimateError()->total() / relMseOf(frame, truth), 1.0, 0.1);
}

TEST(FrameError, degreesOfFreedomAreThoseOfTheSquares) {
    // 12288 values of one each; four squares tell that to a factor.
    const std::vector<float> even(kPixels, 1.0f);
    const auto all = render(even, 2, gaussian, 7).estimate.noiseDegreesOfFreedom;
    ASSERT_TRUE(all);
    EXPECT_GT(*all, 1000.0);
    EXPECT_LE(*all, 12288.0);
    // All noise in one square of four: no more than one number that was drawn.
    FrameErrorSum sum({0, 0, 64, 64});
    for (int i = 0; i < 64 * 64; ++i)
        sum.add(i % 64, i / 64, {i % 64 < 32 && i < 32 * 64 ? 1.0 : 0.0, 0.0, false});
    EXPECT_NEAR(sum.result()->noiseDegreesOfFreedom.value(), 2.0, 1e-9);
}

TEST(FrameError, withoutAProbeThereIsNoBias) {
    const FrameError error = render(variedTruth(), 3, gaussian, 1).estimate;
    EXPECT_EQ(error.bias, 0.0);
    EXPECT_EQ(error.total(), error.noise);
}

TEST(FrameError, notANumberStaysOne) {
    FrameStore frame(kFrame, 3, 0);
    std::vector<float> pixels(3 * kPixels, 1.0f);
    pixels[999] = std::numeric_limits<float>::quiet_NaN();
    for (std::uint32_t pass = 0; pass < 2; ++pass)
        frame.addPass(pass, kFrame, pixels, std::vector<float>(kPixels, 1.0f));
    EXPECT_TRUE(std::isnan(frame.estimateError()->total()));
    EXPECT_TRUE(std::isnan(frame.estimateError()->totalTrimmed()));
}

TEST(FrameError, aFrameOfOnePixelHasOne) {
    FrameStore frame({5, 5, 6, 6}, 3, 0);
    const std::vector<float> weights(1, 1.0f);
    frame.addPass(0, frame.window(), std::vector<float>(3, 1.0f), weights);
    frame.addPass(1, frame.window(), std::vector<float>(3, 3.0f), weights);
    EXPECT_DOUBLE_EQ(frame.estimateError()->noise, 1.0 / 4.01);
}

// The picture in another unit, its probe and its lamps too: with the scale of that unit the same
// error to the bit, with none another.
TEST(FrameError, scaleIsOfTheUnit) {
    const std::vector<float> truth = variedTruth();
    const auto errorOf = [&](int stops, int scale) {
        Random random(5);
        constexpr std::int32_t kAll = 9;  // beauty, probe, lamps
        FrameStore frame(kFrame, kAll, 0, 3, 6, std::nullopt, ErrorScale(scale));
        for (std::uint32_t pass = 0; pass < 6; ++pass) {
            std::vector<float> pixels(kPixels * kAll);
            for (std::size_t i = 0; i < pixels.size(); ++i) {
                const float part = i % kAll < 3 ? 1.0f : i / kAll % 7 == 0 ? 0.5f : 0.1f;
                pixels[i] = std::ldexp(part * gaussian(truth[i / kAll], random), stops);
            }
            frame.addPass(pass, kFrame, pixels, std::vector<float>(kPixels, 4.0f));
        }
        return frame.estimateError().value();
    };
    const FrameError plain = errorOf(0, 0);
    for (const int stops : {-20, -7, 4, 20}) {
        const FrameError scaled = errorOf(stops, -stops);
        EXPECT_EQ(scaled.noise, plain.noise);
        EXPECT_EQ(scaled.noiseTrimmed, plain.noiseTrimmed);
        EXPECT_EQ(scaled.bias, plain.bias);
        EXPECT_EQ(scaled.unresolvedShare, plain.unresolvedShare);
        EXPECT_GT(std::abs(std::log2(errorOf(stops, 0).noise / plain.noise)), 0.1);
    }
}

}  // namespace
}  // namespace pm::test
