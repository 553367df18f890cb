// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "scheduler/film/frame_store.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <vector>

#include "integrator/values/error.h"
#include "scheduler/buckets/fp_environment.h"

namespace pm {
namespace {

constexpr Rect kWindow{-5, -3, 14, 9};
constexpr std::int32_t kChannels = 6, kBeautyFirst = 2;
constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

// One pass of the whole window.
struct Pass {
    std::vector<float> pixels, weights;
};

Pass randomPass(std::mt19937& random, float offset) {
    const auto area = static_cast<std::size_t>(kWindow.area());
    Pass pass{std::vector<float>(area * kChannels), std::vector<float>(area)};
    std::uniform_real_distribution<float> value(0.0f, 1.0f);
    for (std::size_t i = 0; i < area; ++i) {
        pass.weights[i] = static_cast<float>(random() % 5);
        for (std::size_t c = 0; c < kChannels; ++c) {
            // Where there is no sample, nothing may be looked at.
            pass.pixels[i * kChannels + c] =
                pass.weights[i] == 0.0f ? kNaN : offset + value(random);
        }
    }
    return pass;
}

std::vector<Pass> randomPasses(int count, float offset) {
    std::mt19937 random(17);
    std::vector<Pass> passes;
    for (int k = 0; k < count; ++k) passes.push_back(randomPass(random, offset));
    return passes;
}

// The same figures by their definition, in two sweeps over all passes, in long double.
struct Reference {
    int count = 0;
    long double weight = 0.0L, mean = 0.0L, varianceOfMean = 0.0L;
};

Reference reference(const std::vector<Pass>& passes, std::size_t pixel, std::size_t channel) {
    Reference r;
    for (const Pass& pass : passes) {
        if (pass.weights[pixel] == 0.0f) continue;
        ++r.count;
        r.weight += pass.weights[pixel];
        r.mean += static_cast<long double>(pass.weights[pixel]) *
                  pass.pixels[pixel * kChannels + channel];
    }
    if (r.count == 0) return r;
    r.mean /= r.weight;
    long double deviations = 0.0L;
    for (const Pass& pass : passes) {
        if (pass.weights[pixel] == 0.0f) continue;
        const long double d = pass.pixels[pixel * kChannels + channel] - r.mean;
        deviations += pass.weights[pixel] * d * d;
    }
    if (r.count >= 2) r.varianceOfMean = deviations / ((r.count - 1) * r.weight);
    return r;
}

FrameStore filledStore(const std::vector<Pass>& passes) {
    FrameStore frame(kWindow, kChannels, kBeautyFirst);
    std::uint32_t number = 0;
    for (const Pass& pass : passes) frame.addPass(number++, kWindow, pass.pixels, pass.weights);
    return frame;
}

template <typename Check>
void forEachPixel(Check check) {
    std::size_t pixel = 0;
    for (std::int32_t y = kWindow.y0; y < kWindow.y1; ++y) {
        for (std::int32_t x = kWindow.x0; x < kWindow.x1; ++x) check(x, y, pixel++);
    }
}

void expectClose(float value, long double expected, long double relative) {
    EXPECT_NEAR(static_cast<double>(value), static_cast<double>(expected),
                static_cast<double>(relative * std::abs(expected)) + 1e-30);
}

TEST(FrameStore, meanAndStandardErrorAgreeWithLongDouble) {
    // With the offset a variance from the sum of squares in float or double would be lost.
    for (const float offset : {0.0f, 1e4f}) {
        for (const int count : {1, 2, 7, 200}) {
            const auto passes = randomPasses(count, offset);
            const FrameStore frame = filledStore(passes);
            forEachPixel([&](std::int32_t x, std::int32_t y, std::size_t pixel) {
                float values[kChannels];
                frame.read({x, y, x + 1, y + 1}, 0, kChannels, values, 0, 0);
                const auto error = frame.standardError(x, y);
                for (std::size_t c = 0; c < kChannels; ++c) {
                    const Reference r = reference(passes, pixel, c);
                    expectClose(values[c], r.mean, 6.1e-8L);  // one rounding to float
                    EXPECT_EQ(frame.sampleCount(x, y), static_cast<double>(r.weight));
                    if (c < kBeautyFirst || c >= kBeautyFirst + 3) continue;
                    ASSERT_EQ(error.has_value(), r.count >= 2);
                    if (error) {
                        expectClose((*error)[c - kBeautyFirst], std::sqrt(r.varianceOfMean), 1e-6L);
                    }
                }
            });
        }
    }
}

TEST(FrameStore, onePassComesBackUnchanged) {
    const auto passes = randomPasses(1, 0.1f);
    const FrameStore frame = filledStore(passes);
    forEachPixel([&](std::int32_t x, std::int32_t y, std::size_t pixel) {
        float values[kChannels];
        frame.read({x, y, x + 1, y + 1}, 0, kChannels, values, 0, 0);
        for (std::size_t c = 0; c < kChannels; ++c) {
            const bool sampled = passes[0].weights[pixel] > 0.0f;
            EXPECT_EQ(values[c], sampled ? passes[0].pixels[pixel * kChannels + c] : 0.0f);
        }
    });
}

TEST(FrameStore, standardErrorIsUnbiased) {
    // 12000 means of 8 passes each, of standard deviation 0.5: the estimated variance of the mean
    // is 0.25 / 8 on average, itself known to 0.5 %.
    FrameStore frame({0, 0, 4000, 1}, 3, 0);
    std::mt19937 random(5);
    std::normal_distribution<float> value(1.0f, 0.5f);
    const std::vector<float> weights(4000, 4.0f);
    for (std::uint32_t pass = 0; pass < 8; ++pass) {
        std::vector<float> pixels(12000);
        for (float& p : pixels) p = value(random);
        frame.addPass(pass, frame.window(), pixels, weights);
    }
    double variance = 0.0;
    for (std::int32_t x = 0; x < 4000; ++x) {
        const auto error = frame.standardError(x, 0);
        ASSERT_TRUE(error.has_value());
        for (const float e : *error) variance += static_cast<double>(e) * e / 12000.0;
    }
    EXPECT_NEAR(variance, 0.25 / 8.0, 0.03 * 0.25 / 8.0);
}

TEST(FrameStore, weightsThatAreNotAboveZeroCountNothing) {
    FrameStore frame({0, 0, 4, 1}, 3, 0);
    const std::vector<float> pixels(12, kNaN);
    frame.addPass(0, frame.window(), pixels, std::vector<float>{0.0f, -0.0f, -1.0f, kNaN});
    float values[12];
    frame.read(frame.window(), 0, 3, values, 12, 48);
    for (const float v : values) EXPECT_EQ(v, 0.0f);
    for (std::int32_t x = 0; x < 4; ++x) EXPECT_EQ(frame.sampleCount(x, 0), 0.0);
}

TEST(FrameStore, negativeStridesAndPixelsOutside) {
    const auto passes = randomPasses(3, 0.5f);
    const FrameStore frame = filledStore(passes);
    const Rect rect{-9, -6, 4, 12};  // past the left, the top and the bottom
    const auto w = static_cast<std::size_t>(rect.width());
    const auto h = static_cast<std::size_t>(rect.height());
    // Bottom up, mirrored, RGBA with alpha left alone, and off any alignment by a byte.
    constexpr std::size_t kPixel = 16;
    std::vector<char> picture(w * h * kPixel + 1, 77);
    char* const last = picture.data() + 1 + (w * h - 1) * kPixel;
    frame.read(rect, kBeautyFirst, 3, reinterpret_cast<float*>(last),
               -static_cast<std::int64_t>(kPixel), -static_cast<std::int64_t>(w * kPixel));
    for (std::int32_t y = rect.y0; y < rect.y1; ++y) {
        for (std::int32_t x = rect.x0; x < rect.x1; ++x) {
            const auto i =
                static_cast<std::size_t>(y - rect.y0) * w + static_cast<std::size_t>(x - rect.x0);
            float expected[3] = {0.0f, 0.0f, 0.0f};
            if (kWindow.contains(x, y)) {
                frame.read({x, y, x + 1, y + 1}, kBeautyFirst, 3, expected, 12, 12);
                EXPECT_GT(frame.sampleCount(x, y) == 0.0 ? 1.0f : expected[0], 0.0f);
            }
            EXPECT_EQ(std::memcmp(last - i * kPixel, expected, 12), 0) << x << ", " << y;
            for (int alpha = 12; alpha < 16; ++alpha) EXPECT_EQ(last[alpha - 16 * int(i)], 77);
        }
    }
    EXPECT_EQ(picture[0], 77);
    EXPECT_EQ(frame.sampleCount(-6, 0), 0.0);
    EXPECT_EQ(frame.standardError(0, 9), std::nullopt);
}

// Pixels of a pass have an error in common here: means over many of them have that error still,
// which standard errors taken as independent don't know, and differences of halves do.
TEST(FrameStore, HalfDifferencesKeepWhatPixelsHaveInCommon) {
    constexpr std::int32_t kPixels = 500;
    constexpr double kCommon = 0.2, kOwn = 0.5;
    std::mt19937 random(11);
    double squares = 0;
    constexpr int kFrames = 400;
    for (int i = 0; i < kFrames; ++i) {
        FrameStore frame({0, 0, kPixels, 1}, 3, 0);
        const std::vector<float> weights(kPixels, 1.0f);
        for (std::uint32_t pass = 0; pass < 7; ++pass) {  // four even ones and three odd
            const double common = std::normal_distribution<double>(1, kCommon)(random);
            std::normal_distribution<double> own(common, kOwn);
            std::vector<float> pixels(3 * kPixels);
            for (float& p : pixels) p = static_cast<float>(own(random));
            frame.addPass(pass, frame.window(), pixels, weights);
        }
        std::vector<float> halves(3 * kPixels);
        frame.readHalfDifference(frame.window(), halves.data(), 3 * sizeof(float), 0);
        double mean = 0;
        for (std::size_t x = 0; x < kPixels; ++x) mean += static_cast<double>(halves[3 * x]);
        squares += mean / kPixels * mean / kPixels;
    }
    const double expected = (kCommon * kCommon + kOwn * kOwn / kPixels) / 7;
    // Four standard errors of a variance of so many.
    EXPECT_NEAR(squares / kFrames, expected, 4 * std::sqrt(2.0 / kFrames) * expected);
    FrameStore one({0, 0, 1, 1}, 3, 0);
    one.addPass(0, one.window(), std::vector<float>(3, 1.0f), std::vector<float>(1, 1.0f));
    float values[3] = {9, 9, 9};
    one.readHalfDifference(one.window(), values, 0, 0);
    EXPECT_EQ(values[0], 0.0f);
}

TEST(FrameStore, partsOfThePassMakeTheWhole) {
    const auto passes = randomPasses(4, 0.0f);
    const FrameStore whole = filledStore(passes);
    FrameStore parts(kWindow, kChannels, kBeautyFirst);
    std::uint32_t number = 0;
    for (const Pass& pass : passes) {
        forEachPixel([&](std::int32_t x, std::int32_t y, std::size_t pixel) {
            parts.addPass(number, {x, y, x + 1, y + 1},
                          std::span(pass.pixels).subspan(pixel * kChannels, kChannels),
                          std::span(pass.weights).subspan(pixel, 1));
        });
        ++number;
    }
    EXPECT_EQ(parts.estimateError()->noise, whole.estimateError()->noise);
    EXPECT_EQ(parts.estimateError()->noiseTrimmed, whole.estimateError()->noiseTrimmed);
}

TEST(FrameStore, memoryIsWhatIsTaken) {
    const std::uint64_t bytes = FrameStore::memoryBytes({0, 0, 1000, 1000}, 3);
    EXPECT_GE(bytes, 1'000'000u * (3 + 3 + 3 + 2) * 8);
    EXPECT_LE(bytes, 1'000'000u * ((3 + 3 + 3 + 2) * 8 + 8) + 20'000);
    EXPECT_EQ(FrameStore::memoryBytes({0, 0, 1000, 1000}, 3, 0), bytes + 1'000'000u * 3 * 8);
}

TEST(FrameStore, refusesWhatIsNotAllowed) {
    EXPECT_THROW(FrameStore({0, 0, 0, 4}, 3, 0), Error);
    EXPECT_THROW(FrameStore({-2'000'000'000, 0, 2'000'000'000, 4}, 3, 0), Error);
    EXPECT_THROW(FrameStore(kWindow, 2, 0), Error);
    EXPECT_THROW(FrameStore(kWindow, 5, 3), Error);
    EXPECT_THROW(FrameStore(kWindow, 5, -1), Error);
    EXPECT_THROW(FrameStore(kWindow, 5, 0, 3), Error);
    EXPECT_THROW(FrameStore(kWindow, 5, 0, -2), Error);
    EXPECT_THROW(FrameStore(kWindow, 5, 0, -1, 3), Error);
    FrameStore frame(kWindow, 3, 0);
    std::vector<float> floats(12);
    const std::span<const float> f = floats;
    EXPECT_THROW(frame.addPass(0, {18, 0, 20, 1}, f.first(6), f.first(2)), Error);
    EXPECT_THROW(frame.addPass(0, {0, 0, 2, 1}, f.first(5), f.first(2)), Error);
    EXPECT_THROW(frame.addPass(0, {0, 0, 2, 1}, f.first(6), f.first(3)), Error);
    EXPECT_THROW(frame.read({0, 0, 1, 1}, -1, 1, floats.data(), 4, 4), Error);
    EXPECT_THROW(frame.read({0, 0, 1, 1}, 1, 3, floats.data(), 4, 4), Error);
    EXPECT_THROW(frame.read({0, 0, 1, 1}, 0, 4, floats.data(), 4, 4), Error);
    try {
        FrameStore({0, 0, 1 << 29, 1 << 29}, 1000, 0);
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.status(), Status::kOutOfMemory);
    }
}

}  // namespace
}  // namespace pm
