// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// The rule of adaptive samples where the samples of a pass share no noise.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include "scheduler/buckets/bucket_grid.h"
#include "scheduler/film/frame_store.h"
#include "scheduler/film/sample_allotment.h"
#include "tests/scheduler/film/even_atom.h"

namespace pm {
namespace {

constexpr std::int32_t kChannels = 9;  // beauty, and what was seen of it
constexpr std::size_t kPixels = kAtomPixels;
constexpr Rect kAtom{0, 0, 8, 8};
constexpr SampleRule kAlone{1, 64, 0.01, false, false};
constexpr SampleRule kFourAlone{4, 64, 0.01, false, false};

float firstValue(const FrameStore& frame, std::int32_t x, std::int32_t y) {
    float value = 0;
    frame.read({x, y, x + 1, y + 1}, 0, 1, &value, 4, 4);
    return value;
}

// N = 16 (s / (16 T))^(3/4) in four passes, T a third of the threshold for the second pass, an
// eleventh for the third and fourth, then a 24th; to the nearest of 1, 2, 3, 4, 6, 8, 12, ..., of
// the second pass at most 16.
TEST(SamplesAlone, wherePassesShareNoNoiseTheRuleIsFiner) {
    const auto spread = [](double inPass, double finer) {
        return 16 * 0.01 / finer * std::pow(inPass / 4.0, 4.0 / 3);
    };
    for (const double factor : {0.88, 1.0, 1.13})
        for (const unsigned count : {2u, 3u, 4u, 6u, 8u, 12u, 16u, 24u, 32u, 48u}) {
            const double wanted = count == 2 ? std::max(1.75, 2 * factor) : count * factor;
            for (const auto& [passes, finer] : {std::pair{1u, 3.0}, {2u, 11.0}, {4u, 24.0}})
                EXPECT_EQ(samplesOfSpread(kAlone, passes, {spread(wanted, finer)}),
                          passes < 2 ? std::min(count, 16u) : count)
                    << wanted;
        }
    // More than the least is for who wants 1.7 times as many.
    EXPECT_EQ(samplesOfSpread(kFourAlone, 4, {spread(6.7, 24)}), 4u);
    EXPECT_EQ(samplesOfSpread(kFourAlone, 4, {spread(6.9, 24)}), 6u);
    for (const double none : {0.0, std::numeric_limits<double>::quiet_NaN()})
        EXPECT_EQ(samplesOfSpread(kFourAlone, 4, {none}), 4u);
    EXPECT_EQ(samplesOfSpread(kFourAlone, 4, {1e9}), 64u);
    EXPECT_EQ(samplesOfSpread({3, 50, 0.01, false, false}, 4, {1e9}), 50u);
    EXPECT_EQ(samplesOfSpread({32, 64, 0.01, false, false}, 1, {1e9}), 32u);
}

TEST(SamplesAlone, passesMakeUpForWhatEarlierOnesLacked) {
    EXPECT_EQ(madeUp({4, 64, 0.01}, 6, 12, 16), 16);  // not where passes share noise
    EXPECT_EQ(madeUp(kFourAlone, 0, 0, 4), 4);
    EXPECT_EQ(madeUp(kFourAlone, 3, 4, 16), 2 * 16 - 4);
    EXPECT_EQ(madeUp(kFourAlone, 8, 16, 16), 2 * 16);  // at most twice
    EXPECT_EQ(madeUp(kFourAlone, 9, 28 + 32, 16), 5 * 16 - 60);
    EXPECT_EQ(madeUp(kFourAlone, 10, 100, 4), 4);  // at least the least
}

using Counts = std::array<std::uint16_t, kPixels>;

void addSample(SeenSamples& seen, double value) {
    ++seen.samples;
    for (double& sum : seen.sums) sum += value;
    seen.square += 3 * value * value;
}

void addToMean(SeenSamples& seen, double more) {
    seen.square += 2 * 3 * seen.sums[0] * more + seen.samples * 3 * more * more;
    for (double& sum : seen.sums) sum += seen.samples * more;
}

// An atom of which each half has seen samples of normal noise; deviation: of each pixel.
std::array<SeenSamples, kPixels> noisyAtom(std::mt19937& random, unsigned samples,
                                           const std::function<double(std::size_t)>& deviation) {
    std::array<SeenSamples, kPixels> atom;
    for (std::size_t i = 0; i < kPixels; ++i) {
        std::normal_distribution<double> normal(2.0, deviation(i));
        for (unsigned k = 0; k < samples; ++k) addSample(atom[i], normal(random));
    }
    return atom;
}

// Four samples of a pixel make its own spread uncertain by half, so that by itself it would get
// half of what its neighbour gets, or twice that. Twelve wanted, in the middle of a step.
TEST(SamplesAlone, evenNoiseGetsEvenSamples) {
    std::mt19937 random(5);
    const double deviation = 0.32 * std::pow(3.0, 4.0 / 3) / 11 / 2 * std::sqrt(4.01);
    double uneven = 0, others = 0, sum = 0;
    constexpr int kAtoms = 400;
    for (int k = 0; k < kAtoms; ++k) {
        const auto atom = noisyAtom(random, 4, [=](std::size_t) { return deviation; });
        Counts samples{}, weights{};
        allotSamples(kFourAlone, 2, atom, samples, weights);
        for (std::size_t i = 0; i < kPixels; ++i) {
            uneven += samples[i] != samples[0];
            others += weights[i] != samples[i];
            sum += samples[i];
        }
    }
    // Atoms whose pixels differ by chance more than normal noise does by the mean are a sixth.
    EXPECT_LT(uneven, 0.05 * kAtoms * kPixels);
    EXPECT_LT(others, 0.3 * kAtoms * kPixels);
    // A little below 12: what sequences cure is told by noise too, and never more than nothing.
    EXPECT_NEAR(sum / (kAtoms * kPixels), 11.5, 0.6);
}

// A column of noise that is brighter than the smooth pixels beside it stays one.
TEST(SamplesAlone, noiseThatIsNotEvenIsToldApart) {
    std::mt19937 random(6);
    auto atom = noisyAtom(random, 4, [](std::size_t i) { return i % 8 == 5 ? 1.0 : 0.001; });
    for (std::size_t i = 5; i < kPixels; i += 8) addToMean(atom[i], 3);
    Counts samples{};
    allotSamples(kFourAlone, 2, atom, samples);
    double ofColumn = 0;
    for (std::size_t i = 0; i < kPixels; ++i) {
        if (i % 8 == 5) {
            ofColumn += samples[i] / 8.0;
            EXPECT_GT(samples[i], 4u) << i;
        } else if (i % 8 < 4) {
            EXPECT_EQ(samples[i], 4u) << i;
        }
    }
    EXPECT_GT(ofColumn, 12);
}

// Light that few samples meet looks uneven by itself, but means differ by no more than that.
TEST(SamplesAlone, noiseThatFewSamplesMeetGetsEvenSamples) {
    std::mt19937 random(10);
    double uneven = 0, sum = 0;
    constexpr int kAtoms = 400;
    for (int k = 0; k < kAtoms; ++k) {
        std::array<SeenSamples, kPixels> atom;
        for (SeenSamples& seen : atom)
            for (int sample = 0; sample < 4; ++sample)
                addSample(seen, random() % 20 == 0 ? 0.0 : 1.0);
        Counts samples{};
        allotSamples(kFourAlone, 2, atom, samples);
        double mean = 0;
        for (const std::uint16_t count : samples) mean += count / static_cast<double>(kPixels);
        for (const std::uint16_t count : samples) uneven += std::abs(count - mean) > 0.3 * mean;
        sum += mean;
    }
    EXPECT_LT(uneven, 0.08 * kAtoms * kPixels);
    EXPECT_GT(sum / kAtoms, 12);
}

// What the rule gives an atom whose pixels have seen four samples each.
Counts allotted(const std::function<double(std::size_t pixel, int sample)>& value) {
    std::array<SeenSamples, kPixels> atom;
    for (std::size_t i = 0; i < kPixels; ++i)
        for (int sample = 0; sample < 4; ++sample) addSample(atom[i], value(i, sample));
    Counts samples{};
    allotSamples(kFourAlone, 2, atom, samples);
    return samples;
}

// No sample has met the edge, but the pixels on both sides of a step get more, and none in a
// gradient.
TEST(SamplesAlone, anEdgeThatSamplesMissedIsGuessed) {
    const Counts beside = allotted([](std::size_t i, int) { return i % 8 < 4 ? 0.2 : 1.0; });
    const Counts below = allotted([](std::size_t i, int) { return i / 8 < 4 ? 0.2 : 1.0; });
    const Counts ofGradient =
        allotted([](std::size_t i, int) { return 0.2 * static_cast<double>(i % 8); });
    for (std::size_t i = 0; i < kPixels; ++i) {
        EXPECT_EQ(beside[i] > 4, i % 8 == 3 || i % 8 == 4) << i;
        EXPECT_EQ(below[i] > 4, i / 8 == 3 || i / 8 == 4) << i;
        EXPECT_EQ(ofGradient[i], 4u) << i;
    }
}

// One sample of one pixel has met light: beside it there may be some, too, that none has met. A
// step elsewhere shows that pixels are unlike.
TEST(SamplesAlone, pixelsBesideANoisyOneGetMore) {
    const Counts counts = allotted([](std::size_t i, int sample) {
        return i % 8 > 5 ? 2.0 : i == 3 * 8 + 3 && sample == 0 ? 1.0 : 0.0;
    });
    for (const std::size_t beside : {2 * 8 + 3, 3 * 8 + 2, 3 * 8 + 4, 4 * 8 + 3})
        EXPECT_GT(counts[beside], counts[6 * 8 + 1]) << beside;
}

// There bends tell nothing of it.
TEST(SamplesAlone, noiseAtTheAtomsBorderIsToldApart) {
    const Counts counts = allotted(
        [](std::size_t i, int sample) { return i % 8 == 0 ? 0.6 + 0.8 * (sample % 2) : 1.0; });
    for (std::size_t i = 0; i < kPixels; i += 8) EXPECT_GT(counts[i], 2 * counts[i + 5]) << i;
}

// Means of four samples that differ less between pixels than four independent ones would: a
// low-discrepancy sequence has cured the rest. A gradient is no difference.
TEST(SamplesAlone, whatTheSequenceCuresGetsNoSamples) {
    auto cured = evenAtom(4, 2.0, 0.2);
    for (std::size_t i = 0; i < kPixels; ++i)
        addToMean(cured[i], 0.02 * static_cast<double>(i % 8 + i / 8));
    auto apart = cured;
    std::mt19937 random(7);
    for (SeenSamples& seen : apart) {
        // Half of the variance of a mean of four.
        std::normal_distribution<double> normal(0.0, 0.1 * std::numbers::sqrt2 / 2);
        addToMean(seen, normal(random));
    }
    Counts ofCured{}, ofApart{};
    allotSamples(kFourAlone, 2, cured, ofCured);
    allotSamples(kFourAlone, 2, apart, ofApart);
    for (std::size_t i = 0; i < kPixels; ++i) EXPECT_GT(ofApart[i], 1.5 * ofCured[i]) << i;
}

// Whatever a pixel has seen, what its passes weigh is decided by others: else it would lose light.
TEST(SamplesAlone, aPixelHasNoPartInWhatItsPassesWeigh) {
    std::mt19937 random(8);
    for (const unsigned seen : {1u, 4u})
        for (std::size_t pixel = 0; pixel < kPixels; ++pixel) {
            auto atom = noisyAtom(random, seen,
                                  [](std::size_t i) { return 0.02 * static_cast<double>(i % 5); });
            Counts samples{}, before{}, after{};
            allotSamples(kFourAlone, 2, atom, samples, before);
            for (double& sum : atom[pixel].sums) sum *= 30;
            atom[pixel].square *= 5000;
            allotSamples(kFourAlone, 2, atom, samples, after);
            EXPECT_EQ(before[pixel], after[pixel]) << pixel;
            EXPECT_NE(before, after) << pixel;  // its neighbours' do change
        }
}

// Where nothing is shared, passes weigh by what was allotted, here by a spread that asks for all.
TEST(SamplesAlone, halvesWeighByWhatWasAllotted) {
    FrameStore frame(kAtom, kChannels, 0, -1, -1, kFourAlone);
    std::mt19937 random(9);
    const auto add = [&](std::uint32_t pass, float value, float samples) {
        std::vector<float> pixels(kPixels * kChannels, value);
        const auto seen = noisyAtom(random, 4, [](std::size_t) { return 40.0; });
        for (std::size_t i = 0; i < kPixels; ++i) {
            float* const at = pixels.data() + i * kChannels + 3;
            at[0] = 4;
            for (std::size_t c = 0; c < 3; ++c) at[c + 1] = static_cast<float>(seen[i].sums[c]);
            at[4] = static_cast<float>(seen[i].square);
        }
        frame.addPass(pass, kAtom, pixels, std::vector<float>(kPixels, samples));
    };
    add(0, 1.0f, 4.0f);
    add(1, 5.0f, 7.0f);  // weighs 16, the most of a second pass, whatever its samples
    EXPECT_FLOAT_EQ(firstValue(frame, 4, 4), (4 * 1.0f + 16 * 5.0f) / 20);
    add(2, 4.0f, 4.0f);  // of the even half, mean 2.5, with what it makes up for: 128
    EXPECT_FLOAT_EQ(firstValue(frame, 4, 4), (128 * 2.5f + 16 * 5.0f) / 144);
    // Its variance as the halves': 7 samples of one, 8 of the other, of passes 1, 5, 4.
    const double mean = (4 * 1.0 + 7 * 5.0 + 4 * 4.0) / 15;
    const double ofSample =
        (4 * (1 - mean) * (1 - mean) + 7 * (5 - mean) * (5 - mean) + 4 * (4 - mean) * (4 - mean)) /
        2;
    const double variance = ofSample * (64.0 / 81 / 8 + 1.0 / 81 / 7);
    EXPECT_NEAR((*frame.standardError(4, 4))[0], std::sqrt(variance), 1e-5);
}

}  // namespace
}  // namespace pm
