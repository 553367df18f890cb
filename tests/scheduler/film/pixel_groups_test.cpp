// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Level 0: pixels that begin in groups of 2 x 2, and what becomes of them in the frame store.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <functional>
#include <random>
#include <vector>

#include "scheduler/buckets/bucket_grid.h"
#include "scheduler/film/frame_store.h"

namespace pm {
namespace {

constexpr std::int32_t kChannels = 10;  // beauty, SeenSamples, contribution
constexpr Rect kAtom{0, 0, 8, 8};
constexpr Rect kWindow{3, 1, 16, 8};  // cuts groups and an atom

struct Shown {
    float value = 1.0f, contribution = 5.0f;
};
using Sample = std::function<Shown(std::int32_t x, std::int32_t y)>;

FrameStore groupFrame(const Rect& window = kAtom, std::uint32_t mostLevel = 1) {
    return {window, kChannels, 0, -1, -1, sampleRule(0, mostLevel, 0.01)};
}

// One sample: of a group as long as a pixel is one of its, else of the pixel. The samples of either
// in each pass.
void addPass(FrameStore& frame, std::uint32_t pass, const Sample& ofGroup, const Sample& ofPixel) {
    const Rect rect = wholeAtoms(frame.window());
    const auto area = static_cast<std::size_t>(rect.area());
    std::vector<FrameStore::NextSamples> next(area);
    frame.nextSamples(pass, rect, next);
    std::vector<float> pixels, weights;
    for (std::size_t i = 0; i < area; ++i) {
        const std::int32_t x = rect.x0 + static_cast<std::int32_t>(i) % rect.width();
        const std::int32_t y = rect.y0 + static_cast<std::int32_t>(i) / rect.width();
        const Shown shown = next[i].isOfGroup ? ofGroup(x & ~1, y & ~1) : ofPixel(x, y);
        const float v = shown.value;
        pixels.insert(pixels.end(), {v, v, v, 1, v, v, v, 3 * v * v, 0, shown.contribution});
        weights.push_back(next[i].isOfGroup ? 0.25f : 1.0f);
    }
    frame.addPass(pass, rect, pixels, weights);
}

Sample always(float value, float contribution = 5.0f) {
    return [=](std::int32_t, std::int32_t) { return Shown{value, contribution}; };
}

float valueOf(const FrameStore& frame, std::int32_t x, std::int32_t y) {
    float value = 0;
    frame.read({x, y, x + 1, y + 1}, 0, 1, &value, 4, 4);
    return value;
}

FrameStore::NextSamples nextOf(const FrameStore& frame, std::uint32_t pass, std::int32_t x,
                               std::int32_t y) {
    FrameStore::NextSamples next;
    frame.nextSamples(pass, {x, y, x + 1, y + 1}, {&next, 1});
    return next;
}

TEST(PixelGroups, stayTogetherWhereTheirSamplesAgree) {
    FrameStore frame = groupFrame();
    addPass(frame, 0, always(1.0f), always(0));
    addPass(frame, 1, always(1.02f), always(0));
    for (std::int32_t y = 0; y < 8; ++y)
        for (std::int32_t x = 0; x < 8; ++x) {
            EXPECT_TRUE(frame.showsGroup(x, y));
            EXPECT_TRUE(nextOf(frame, 2, x, y).isOfGroup);
            EXPECT_EQ(frame.sampleCount(x, y), 0.5);
            EXPECT_FLOAT_EQ(valueOf(frame, x, y), 1.01f);
        }
    EXPECT_FALSE(frame.showsGroup(8, 0));
    // The variance of the mean of two numbers 0.02 apart.
    EXPECT_NEAR((*frame.standardError(3, 3))[0], 0.01f, 1e-7f);
}

// Of a group that shows two things, or whose samples are too far apart, the pixels go on alone;
// they show the group until they have samples of their own, and nothing of it from then on.
TEST(PixelGroups, divideWhereTheirSamplesDiffer) {
    const auto isUnlike = [](std::int32_t x, std::int32_t y) { return x == 2 && y == 4; };
    const auto isApart = [](std::int32_t x, std::int32_t y) { return x == 6 && y == 0; };
    FrameStore frame = groupFrame();
    addPass(frame, 0, always(1.0f), always(0));
    addPass(
        frame, 1,
        [&](std::int32_t x, std::int32_t y) {
            return Shown{isApart(x, y) ? 1.5f : 1.0f, isUnlike(x, y) ? 6.0f : 5.0f};
        },
        always(0));
    const auto isDivided = [&](std::int32_t x, std::int32_t y) {
        return isUnlike(x & ~1, y & ~1) || isApart(x & ~1, y & ~1);
    };
    for (std::int32_t y = 0; y < 8; ++y)
        for (std::int32_t x = 0; x < 8; ++x) {
            const FrameStore::NextSamples next = nextOf(frame, 2, x, y);
            EXPECT_EQ(next.isOfGroup, !isDivided(x, y)) << x << "," << y;
            EXPECT_EQ(next.had, 0u);
            EXPECT_TRUE(frame.showsGroup(x, y));
            EXPECT_EQ(valueOf(frame, x, y), isApart(x & ~1, y & ~1) ? 1.25f : 1.0f);
        }
    addPass(frame, 2, always(1.0f), always(7.0f, 3.0f));
    addPass(frame, 3, always(1.0f), always(9.0f, 4.0f));
    for (std::int32_t y = 0; y < 8; ++y)
        for (std::int32_t x = 0; x < 8; ++x) {
            EXPECT_EQ(frame.showsGroup(x, y), !isDivided(x, y));
            EXPECT_EQ(valueOf(frame, x, y), isDivided(x, y) ? 8.0f : 1.0f);
            EXPECT_EQ(frame.sampleCount(x, y), isDivided(x, y) ? 2.0 : 1.0);
        }
}

// By the spread of two samples, sqrt(2) / 2 of what they are apart, a pixel would get 16 samples in
// four passes; relative to the mean as relMSE is.
TEST(PixelGroups, ColoursDifferFromAStatedSpreadOn) {
    for (const double mean : {0.05, 1.0, 20.0})
        for (const double share : {0.99, 1.01}) {
            const double spread = share * 16 * 0.01 * std::sqrt(mean * mean + 0.01);
            const double off = spread / std::sqrt(2.0);
            FrameStore frame = groupFrame();
            addPass(frame, 0, always(static_cast<float>(mean - off)), always(0));
            addPass(frame, 1, always(static_cast<float>(mean + off)), always(0));
            EXPECT_EQ(nextOf(frame, 2, 0, 0).isOfGroup, share < 1) << mean;
        }
}

// What no order of numbers holds for divides, and is forgotten with the group.
TEST(PixelGroups, ANumberThatIsNoneDivides) {
    FrameStore frame = groupFrame();
    addPass(frame, 0, always(std::nanf("")), always(0));
    addPass(frame, 1, always(1.0f), always(0));
    EXPECT_FALSE(nextOf(frame, 2, 0, 0).isOfGroup);
    addPass(frame, 2, always(1.0f), always(2.0f));
    EXPECT_EQ(valueOf(frame, 0, 0), 2.0f);
}

// At the higher levels the pixels of a divided group get samples by its spread at once.
TEST(PixelGroups, TheirSpreadAllotsSamples) {
    for (const std::uint32_t mostLevel : {1u, 3u}) {
        FrameStore frame = groupFrame(kAtom, mostLevel);
        addPass(frame, 0, always(1.0f), always(0));
        addPass(
            frame, 1,
            [](std::int32_t x, std::int32_t) {
                return Shown{x == 0 ? 3.0f : 1.0f, 5.0f};
            },
            always(0));
        // Even passes by what the odd ones show.
        EXPECT_EQ(nextOf(frame, 2, 1, 3).count, mostLevel == 1 ? 0u : 4u);
        EXPECT_EQ(nextOf(frame, 3, 1, 3).count, 0u);
        EXPECT_EQ(nextOf(frame, 2, 5, 3).count, 0u);
    }
}

// Light that 1 sample in 50 sees, where the group is divided by what it shows: its pixels' own
// samples know nothing of what divided it. A store that kept the group's samples would find several
// times as much: of those of a divided group every other one sees it.
TEST(PixelGroups, DividingLeavesNoBias) {
    std::mt19937_64 random(3);
    const Sample rare = [&random](std::int32_t, std::int32_t) {
        return Shown{random() % 50 == 0 ? 1.0f : 0.0f, 5.0f};
    };
    double sum = 0, squares = 0, count = 0;
    for (int i = 0; i < 30'000; ++i) {
        FrameStore frame = groupFrame();
        // The pixels of a group have to have one sample.
        std::vector<Shown> shown(16);
        for (std::uint32_t pass = 0; pass < 4; ++pass) {
            for (Shown& s : shown) s = rare(0, 0);
            addPass(
                frame, pass,
                [&](std::int32_t x, std::int32_t y) {
                    return shown[static_cast<std::size_t>(y / 2 * 4 + x / 2)];
                },
                rare);
        }
        for (std::int32_t y = 0; y < 8; ++y)
            for (std::int32_t x = 0; x < 8; ++x) {
                if (frame.showsGroup(x, y)) continue;
                const auto value = static_cast<double>(valueOf(frame, x, y));
                sum += value;
                squares += value * value;
                ++count;
            }
    }
    EXPECT_GT(count, 50'000);
    const double mean = sum / count;
    EXPECT_LT(std::abs(mean - 0.02) / std::sqrt((squares / count - mean * mean) / count), 4);
}

// A pixel's bits in a window that cuts its group are those of the whole frame.
TEST(PixelGroups, DoNotDependOnTheWindow) {
    FrameStore part = groupFrame(kWindow, 3), whole = groupFrame({0, 0, 24, 16}, 3);
    for (std::uint32_t pass = 0; pass < 5; ++pass)
        for (FrameStore* frame : {&part, &whole}) {
            const auto sample = [pass](std::int32_t x, std::int32_t y) {
                std::mt19937 random(static_cast<unsigned>(x * 977 + y * 131) + pass * 7919);
                return Shown{1.0f + static_cast<float>(random() % 100) / 300, 5.0f};
            };
            addPass(*frame, pass, sample, sample);
        }
    int groups = 0;
    for (std::int32_t y = kWindow.y0; y < kWindow.y1; ++y)
        for (std::int32_t x = kWindow.x0; x < kWindow.x1; ++x) {
            EXPECT_EQ(valueOf(part, x, y), valueOf(whole, x, y));
            EXPECT_EQ(part.showsGroup(x, y), whole.showsGroup(x, y));
            EXPECT_EQ(nextOf(part, 5, x, y).count, nextOf(whole, 5, x, y).count);
            groups += part.showsGroup(x, y);
        }
    EXPECT_GT(groups, 5);
    EXPECT_LT(groups, static_cast<int>(kWindow.area()) - 5);
}

}  // namespace
}  // namespace pm
