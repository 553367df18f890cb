// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// What frames make of the samples that a rule allots.
#include <gtest/gtest.h>

#include <cmath>
#include <compare>
#include <cstdint>
#include <functional>
#include <map>
#include <random>
#include <vector>

#include "integrator/values/error.h"
#include "scheduler/buckets/bucket_grid.h"
#include "scheduler/film/frame_store.h"
#include "scheduler/film/sample_allotment.h"

namespace pm {
namespace {

constexpr std::int32_t kChannels = 9;  // beauty, and what was seen of it
constexpr std::size_t kPixels = kAtomPixels;
constexpr Rect kAtom{0, 0, 8, 8};
constexpr SampleRule kTwoAtLeast{2, 64, 0.01};
constexpr SampleRule kRule{1, 64, 0.01};
constexpr SampleRule kFourAtLeast{4, 64, 0.01};
// The samples of a pass share no noise.
constexpr SampleRule kAlone{1, 64, 0.01, false, false};
constexpr SampleRule kTwoAlone{2, 64, 0.01, false, false};
constexpr SampleRule kFourAlone{4, 64, 0.01, false, false};

using Sample = std::function<float(std::size_t pixel, std::uint32_t half, std::uint32_t index)>;

// Renders passes of the frame's samples: what a renderer of light would do.
void addPass(FrameStore& frame, std::uint32_t pass, const Rect& rect, const Sample& sample,
             std::uint32_t seen = kRule.least) {
    const auto area = static_cast<std::size_t>(rect.area());
    std::vector<FrameStore::NextSamples> next(area);
    frame.nextSamples(pass, rect, next);
    std::vector<float> pixels(area * kChannels), weights(area);
    for (std::size_t i = 0; i < area; ++i) {
        double sum = 0;
        float* const pixel = pixels.data() + i * kChannels;
        for (std::uint32_t k = 0; k < next[i].count; ++k) {
            const auto value = static_cast<double>(sample(i, pass % 2, next[i].had + k));
            sum += value;
            if (k >= seen) continue;
            ++pixel[3];
            for (std::size_t c = 4; c < 7; ++c) pixel[c] += static_cast<float>(value);
            pixel[7] += static_cast<float>(3 * value * value);
        }
        const double count = next[i].count;
        weights[i] = static_cast<float>(count);
        if (count == 0) continue;
        for (std::size_t c = 0; c < 3; ++c) pixel[c] = static_cast<float>(sum / count);
    }
    frame.addPass(pass, rect, pixels, weights);
}

float firstValue(const FrameStore& frame, std::int32_t x, std::int32_t y) {
    float value = 0;
    frame.read({x, y, x + 1, y + 1}, 0, 1, &value, 4, 4);
    return value;
}

// Light that one sample in 50 sees, at 1 to 64 samples a pass: what lets a pixel that decides by
// its own samples lose two thirds of it. z of the mean over `renders` atoms of 64 pixels.
double rareLightScore(int renders, const std::function<double(std::mt19937_64&)>& pixelMean) {
    std::mt19937_64 random(7);
    double sum = 0, squares = 0;
    for (int i = 0; i < renders; ++i) {
        const double value = pixelMean(random);
        sum += value;
        squares += value * value;
    }
    const double mean = sum / renders;
    const double variance = (squares / renders - mean * mean) / (renders - 1);
    return (mean - 0.02) / std::sqrt(variance);
}

// 102,400 pixels: each atom is 64 seeds of a pixel that its neighbours help to decide. The halves
// decide by the first `seen` samples of each pass.
double rareLightOfAtoms(std::uint32_t seen, const SampleRule& rule = kRule) {
    return rareLightScore(1600, [seen, &rule](std::mt19937_64& random) {
        FrameStore frame(kAtom, kChannels, 0, -1, -1, rule);
        for (std::uint32_t pass = 0; pass < 10; ++pass)
            addPass(
                frame, pass, kAtom,
                [&random](std::size_t, std::uint32_t, std::uint32_t) {
                    return random() % 50 == 0 ? 1.0f : 0.0f;
                },
                seen);
        double sum = 0;
        for (std::int32_t y = 0; y < 8; ++y)
            for (std::int32_t x = 0; x < 8; ++x)
                sum += static_cast<double>(firstValue(frame, x, y));
        return sum / kPixels;
    });
}

// What pixel 27 met in each pass: of samples, how many saw light, of those that decide and of
// others.
struct Met {
    std::uint32_t deciding = 0, others = 0;
    auto operator<=>(const Met&) const = default;
};

// One pixel alone, whose halves decide for each other: the neighbours can't hide a bias. A step far
// from it shows that pixels are unlike. What the pixel met says all of a render, so each such story
// is rendered once.
class LonePixel {
  public:
    LonePixel(std::uint32_t seen, const SampleRule& rule) : m_seen(seen), m_rule(rule) {}

    double render(std::mt19937_64& random) {
        std::vector<Met> story;
        while (story.size() < kPasses) {
            const auto samples = static_cast<std::uint32_t>(after(story));
            Met met;
            for (std::uint32_t k = 0; k < samples; ++k)
                if (random() % 50 == 0) ++(k < m_seen ? met.deciding : met.others);
            story.push_back(met);
        }
        return after(story);
    }

  private:
    static constexpr std::size_t kPasses = 4;

    // Samples of the next pass; after the last the pixel's mean.
    double after(const std::vector<Met>& story) {
        const auto known = m_after.find(story);
        if (known != m_after.end()) return known->second;
        FrameStore frame(kAtom, kChannels, 0, -1, -1, m_rule);
        for (std::uint32_t pass = 0; pass < story.size(); ++pass) {
            const Met& met = story[pass];
            std::uint32_t k = 0;
            addPass(
                frame, pass, kAtom,
                [&](std::size_t pixel, std::uint32_t, std::uint32_t) {
                    if (pixel != 27) return pixel % 8 > 5 ? 1.0f : 0.0f;
                    const bool decides = k < m_seen;
                    const std::uint32_t place = decides ? k : k - m_seen;
                    ++k;
                    return place < (decides ? met.deciding : met.others) ? 1.0f : 0.0f;
                },
                m_seen);
        }
        double result = static_cast<double>(firstValue(frame, 3, 3));
        if (story.size() < kPasses) {
            std::vector<FrameStore::NextSamples> next(kPixels);
            frame.nextSamples(static_cast<std::uint32_t>(story.size()), kAtom, next);
            result = next[27].count;
        }
        return m_after.emplace(story, result).first->second;
    }

    std::uint32_t m_seen;
    SampleRule m_rule;
    std::map<std::vector<Met>, double> m_after;
};

// Of 100,000 renders.
double rareLightOfALonePixel(std::uint32_t seen, const SampleRule& rule) {
    LonePixel pixel(seen, rule);
    return rareLightScore(100'000,
                          [&pixel](std::mt19937_64& random) { return pixel.render(random); });
}

TEST(AllottedFrame, rareLightIsNotLost) {
    EXPECT_LT(std::abs(rareLightOfAtoms(kRule.least)), 4.0);
    // Passes of several samples also tell what they share.
    EXPECT_LT(std::abs(rareLightOfAtoms(kFourAtLeast.least, kFourAtLeast)), 4.0);
    EXPECT_LT(std::abs(rareLightOfAtoms(kAlone.least, kAlone)), 4.0);
}

// A twin: halves that decide for each other by all samples that they have. A half then decides for
// itself, by way of the other one.
TEST(AllottedFrame, decidingByAllSamplesWouldLoseRareLight) {
    EXPECT_LT(rareLightOfAtoms(64), -10.0);
    EXPECT_LT(rareLightOfALonePixel(64, kTwoAlone), -5.0);
}

TEST(AllottedFrame, rareLightOfALonePixelIsNotLost) {
    EXPECT_LT(std::abs(rareLightOfALonePixel(kTwoAtLeast.least, kTwoAtLeast)), 4.0);
    EXPECT_LT(std::abs(rareLightOfALonePixel(kTwoAlone.least, kTwoAlone)), 4.0);
}

// A twin: a pixel that decides by the samples which it then keeps.
TEST(AllottedFrame, decidingByItsOwnSamplesWouldLoseRareLight) {
    const double score = rareLightScore(100'000, [](std::mt19937_64& random) {
        const auto see = [&random] { return random() % 50 == 0 ? 1.0 : 0.0; };
        double sum = 0;
        int count = 0;
        for (; count < 4; ++count) sum += see();
        if (sum > 0)
            for (; count < 64; ++count) sum += see();
        return sum / count;
    });
    EXPECT_LT(score, -40.0);
}

// Pass 0 with the least decides for pass 1, pass 1 for pass 2; where nothing is shared, pass 2
// makes up for pass 0.
TEST(AllottedFrame, theFirstPassDecidesForTheSecond) {
    for (const SampleRule& rule : {kFourAtLeast, kFourAlone}) {
        FrameStore frame(kAtom, kChannels, 0, -1, -1, rule);
        double counts[3];
        for (std::uint32_t pass = 0; pass < 3; ++pass) {
            addPass(
                frame, pass, kAtom,
                [](std::size_t pixel, std::uint32_t half, std::uint32_t index) {
                    std::mt19937 random(static_cast<unsigned>(pixel) * 977 + half * 7919 +
                                        index * 104729);
                    const float value = static_cast<float>(random() % 1000) / 1000.0f;
                    return value * value * value;
                },
                rule.least);
            counts[pass] = frame.sampleCount(3, 3);
        }
        EXPECT_EQ(counts[0], 4);
        const double second = counts[1] - counts[0], third = counts[2] - counts[1];
        EXPECT_GT(second, 4);
        if (rule.sharesNoise)
            EXPECT_GT(third, 4);
        else
            EXPECT_EQ(third, 2 * 64 - 4);
    }
}

// What the fifth pass is the first to meet decides for the sixth; where nothing is shared not yet.
TEST(AllottedFrame, theLastPassDecidesForTheNext) {
    for (const SampleRule& rule : {kFourAtLeast, kFourAlone}) {
        FrameStore frame(kAtom, kChannels, 0, -1, -1, rule);
        for (std::uint32_t pass = 0; pass < 5; ++pass)
            addPass(
                frame, pass, kAtom,
                [pass](std::size_t, std::uint32_t, std::uint32_t index) {
                    return pass < 4 ? 1.0f : index % 2 == 0 ? 0.5f : 1.5f;
                },
                rule.least);
        std::vector<FrameStore::NextSamples> next(kPixels);
        frame.nextSamples(5, kAtom, next);
        EXPECT_EQ(next[20].count > 4, rule.sharesNoise);
        frame.nextSamples(6, kAtom, next);
        EXPECT_EQ(next[20].count, 4u);
    }
}

// Where each pass's samples share noise, what it is is found, and fewer samples are allotted: in
// half of the picture; by the other half of the passes.
TEST(AllottedFrame, passesThatDifferGetFewerSamples) {
    const SampleRule& rule = kFourAtLeast;
    const Rect two{0, 0, 16, 8};
    double left = 0, right = 0;
    for (unsigned seed = 0; seed < 20; ++seed) {
        FrameStore frame(two, kChannels, 0, -1, -1, rule);
        std::mt19937 random(seed);
        std::normal_distribution<float> normal;
        for (std::uint32_t pass = 0; pass < 4; ++pass) {
            float shared[128];
            for (float& s : shared) s = 0.3f * normal(random);
            addPass(
                frame, pass, two,
                [&](std::size_t pixel, std::uint32_t, std::uint32_t) {
                    const bool isLeft = pixel % 16 < 8;
                    return 2.0f + 0.4f * normal(random) + (isLeft ? shared[pixel] : 0.0f);
                },
                rule.least);
        }
        std::vector<FrameStore::NextSamples> next(128);
        frame.nextSamples(4, two, next);
        for (std::size_t i = 0; i < next.size(); ++i)
            (i % 16 < 8 ? left : right) += next[i].count / (64.0 * 20);
    }
    // A spread of 0.2 gets 9.2 by the threshold, 2.8 by the 0.15 that passes differ by.
    EXPECT_LT(left, 5.0);
    EXPECT_GT(right, 7.0);
}

float noiseAt(std::int32_t x, std::int32_t y, std::uint32_t half, std::uint32_t index) {
    std::minstd_rand random(static_cast<unsigned>(x * 977 + y * 131) + half * 7919 +
                            index * 104729);
    random.discard(2);  // seeds that are close begin alike
    return static_cast<float>(random() % 1000) / (x > 10 ? 1000.0f : 1e6f) + 1.0f;
}

// A pixel's bits in a window that cuts its atom are those of the whole frame.
void expectACropChangesNothing(const SampleRule& rule) {
    const Rect whole{0, 0, 32, 24}, crop{5, 3, 19, 21};
    FrameStore all(whole, kChannels, 0, -1, -1, rule), part(crop, kChannels, 0, -1, -1, rule);
    for (std::uint32_t pass = 0; pass < 6; ++pass)
        for (FrameStore* frame : {&all, &part}) {
            const Rect rect = frame == &all ? whole : wholeAtoms(crop);
            addPass(
                *frame, pass, rect,
                [&rect](std::size_t i, std::uint32_t half, std::uint32_t index) {
                    const auto at = static_cast<std::int32_t>(i);
                    return noiseAt(rect.x0 + at % rect.width(), rect.y0 + at / rect.width(), half,
                                   index);
                },
                rule.least);
        }
    for (std::int32_t y = crop.y0; y < crop.y1; ++y)
        for (std::int32_t x = crop.x0; x < crop.x1; ++x) {
            EXPECT_EQ(firstValue(all, x, y), firstValue(part, x, y)) << x << ", " << y;
            EXPECT_EQ(all.sampleCount(x, y), part.sampleCount(x, y));
        }
    EXPECT_GT(all.sampleCount(15, 10), all.sampleCount(2, 2));
    // Nothing is told of what lies in the atoms but not in the window.
    EXPECT_EQ(firstValue(part, 0, 0), 0.0f);
    EXPECT_EQ(part.sampleCount(0, 0), 0.0);
}

TEST(AllottedFrame, aCropChangesNothing) {
    expectACropChangesNothing(kRule);
    expectACropChangesNothing(kFourAlone);
}

// Each half counts by its passes, not by its samples.
TEST(AllottedFrame, halvesWeighByTheirPasses) {
    FrameStore frame(kAtom, kChannels, 0, -1, -1, kRule);
    const auto add = [&frame](std::uint32_t pass, float value, float samples) {
        std::vector<float> pixels(kPixels * kChannels, value);
        frame.addPass(pass, kAtom, pixels, std::vector<float>(kPixels, samples));
    };
    add(0, 1.0f, 1.0f);
    add(1, 5.0f, 63.0f);
    EXPECT_FLOAT_EQ(firstValue(frame, 4, 4), 3.0f);
    add(2, 4.0f, 2.0f);  // of the even half, mean 3
    EXPECT_FLOAT_EQ(firstValue(frame, 4, 4), (2 * 3.0f + 5.0f) / 3);
    EXPECT_EQ(frame.sampleCount(4, 4), 66.0);
}

// The standard error tells of the half with few samples, too.
TEST(AllottedFrame, standardErrorIsThatOfTheHalves) {
    std::mt19937 random(3);
    std::normal_distribution<float> normal;
    const float samples[4] = {4.0f, 4.0f, 4.0f, 60.0f};  // of passes 0 to 3
    double estimated = 0, squares = 0;
    constexpr int kFrames = 200;
    for (int i = 0; i < kFrames; ++i) {
        FrameStore frame(kAtom, kChannels, 0, -1, -1, kRule);
        for (std::uint32_t pass = 0; pass < 4; ++pass) {
            std::vector<float> pixels(kPixels * kChannels);
            for (float& p : pixels) p = 2.0f + normal(random) / std::sqrt(samples[pass]);
            frame.addPass(pass, kAtom, pixels, std::vector<float>(kPixels, samples[pass]));
        }
        for (std::int32_t x = 0; x < 8; ++x) {
            const double error = static_cast<double>((*frame.standardError(x, 5))[0]);
            const double off = static_cast<double>(firstValue(frame, x, 5)) - 2.0;
            estimated += error * error / (8 * kFrames);
            squares += off * off / (8 * kFrames);
        }
    }
    const double expected = 0.25 / 8 + 0.25 / 64;
    // Squares of 1600 normal numbers are known to 3.5 %, the estimates (3 degrees of freedom) to 2
    // %.
    EXPECT_NEAR(squares, expected, 4 * 0.035 * expected);
    EXPECT_NEAR(estimated, expected, 4 * 0.02 * expected);
}

TEST(AllottedFrame, refusesPassesThatCannotBe) {
    EXPECT_THROW(FrameStore(kAtom, 7, 0, -1, -1, kRule), Error);
    FrameStore frame(kAtom, kChannels, 0, -1, -1, kRule);
    const std::vector<float> floats(4 * 4 * kChannels);
    EXPECT_THROW(frame.addPass(0, {0, 0, 4, 4}, floats, std::span(floats).first(16)), Error);
}

}  // namespace
}  // namespace pm
