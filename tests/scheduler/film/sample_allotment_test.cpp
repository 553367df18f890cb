// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "scheduler/film/sample_allotment.h"

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>

#include "integrator/values/error.h"
#include "scheduler/buckets/bucket_grid.h"
#include "tests/scheduler/film/even_atom.h"

namespace pm {
namespace {

constexpr std::size_t kPixels = kAtomPixels;
constexpr SampleRule kRule{1, 64, 0.01};
// The samples of a pass share no noise.
constexpr SampleRule kAlone{1, 64, 0.01, false, false};

// What the rule gives all pixels of an even atom, whose spread is well known.
std::uint16_t samplesOf(std::uint32_t passes, double mean, double deviation,
                        const SampleRule& rule = kRule) {
    std::array<std::uint16_t, kPixels> samples{};
    allotSamples(rule, passes, evenAtom(1000, mean, deviation), samples);
    for (const std::uint16_t count : samples) EXPECT_EQ(count, samples[0]);
    return samples[0];
}

// Light in another unit gets the same samples by the scale of that unit.
TEST(SampleAllotment, scaleIsOfTheUnit) {
    for (SampleRule rule : {kRule, kAlone})
        for (const double mean : {0.02, 0.3})
            for (const int stops : {-20, -5, 6, 20}) {
                rule.errorScale = {};
                const std::uint16_t plain = samplesOf(4, mean, 0.05, rule);
                const double inUnit = std::ldexp(1.0, stops);
                rule.errorScale = ErrorScale(-stops);
                EXPECT_EQ(samplesOf(4, mean * inUnit, 0.05 * inUnit, rule), plain);
                rule.errorScale = {};
                EXPECT_NE(samplesOf(4, 0.02 * inUnit, 0.05 * inUnit, rule),
                          samplesOf(4, 0.02, 0.05, rule));
            }
    SeenSamples seen{8, {0.1, 0.1, 0.1}, 0.01};
    SampleRule rule{0, 64, 0.005, true};
    const bool isPlain = isDivided(rule, seen, seen);
    for (double* const value : {&seen.sums[0], &seen.sums[1], &seen.sums[2]}) *value /= 1024;
    seen.square /= 1024 * 1024;
    rule.errorScale = ErrorScale(10);
    EXPECT_EQ(isDivided(rule, seen, seen), isPlain);
    rule.errorScale = {};
    EXPECT_NE(isDivided(rule, seen, seen), isPlain);
}

TEST(SampleAllotment, samplesGrowWithTheRelativeSpread) {
    // From the fifth pass on, s relative to sqrt(r^2 + 0.01), to the nearest power of two: the root
    // of 6 s / (0.04 / sqrt(8)), but beyond s = 0.7 in proportion to it.
    const double perSpread = std::sqrt(8) / 0.04;
    const auto samplesAt = [](double spread) {
        return samplesOf(4, 2.0, spread * std::sqrt(4.01));
    };
    for (const double factor : {0.72, 1.0, 1.4}) {
        for (const unsigned count : {2u, 4u, 8u})
            EXPECT_EQ(samplesAt(factor * count * factor * count / (6 * perSpread)), count)
                << factor;
        EXPECT_EQ(samplesAt(factor * 32 * 0.7 / std::sqrt(6 * perSpread * 0.7)), 32u) << factor;
    }
    // At most and at least what the rule allows; a spread that is no number asks for nothing.
    EXPECT_EQ(samplesOf(2, 2.0, 0.0), 1u);
    EXPECT_EQ(samplesOf(2, 2.0, 1e3), 64u);
    EXPECT_EQ(samplesOf(2, 2.0, std::numeric_limits<double>::quiet_NaN()), 1u);
    EXPECT_EQ(samplesOf(2, 2.0, 1e3, {3, 100, 0.01}), 100u);
    EXPECT_EQ(samplesOf(2, 2.0, 0.0, {0, 64, 0.01}), 0u);
}

// From the third pass on what is beyond a spread of 0.25 is not tempered where there is an edge:
// sqrt(6 s / 0.02), up to s = 0.7 or 0.25.
TEST(SampleAllotment, rareLightBeginsEarlierAtEdges) {
    const auto samplesAt = [](std::uint32_t passes, double spread, bool hasEdge) {
        return samplesOfSpread(kRule, passes, {spread, 0, hasEdge});
    };
    EXPECT_EQ(samplesAt(2, 0.24, false), 8u);
    EXPECT_EQ(samplesAt(2, 0.24, true), 8u);
    EXPECT_EQ(samplesAt(2, 0.7, false), 16u);  // 14.5
    EXPECT_EQ(samplesAt(2, 0.7, true), 32u);   // 24.2
    EXPECT_EQ(samplesAt(1, 0.7, true), samplesAt(1, 0.7, false));
}

// An even picture, whose pixels need no more samples one than another, gets none that are odd.
TEST(SampleAllotment, samplesArePowersOfTwo) {
    for (double deviation = 0.01; deviation < 10; deviation *= 1.1) {
        const std::uint16_t count = samplesOf(2, 1.0, deviation);
        EXPECT_TRUE(std::has_single_bit(count)) << count;
    }
}

TEST(SampleAllotment, thresholdFallsAfterOneTwoAndFourPasses) {
    // Half of it after two passes, over sqrt(8) after four: just below and above the border between
    // 4 and 8.
    const auto samplesAfter = [](std::uint32_t passes, double ofBorder, double divided) {
        const double samples = ofBorder * 4 * std::numbers::sqrt2;
        const double spread = samples * samples / 6 * 0.04 / divided;
        return samplesOf(passes, 2.0, spread * std::sqrt(4.01));
    };
    EXPECT_EQ(samplesAfter(1, 0.97, 1), 4u);
    EXPECT_EQ(samplesAfter(1, 1.03, 1), 8u);
    EXPECT_EQ(samplesAfter(2, 0.97, 2), 4u);
    EXPECT_EQ(samplesAfter(2, 1.03, 2), 8u);
    for (const std::uint32_t passes : {4u, 64u}) {
        EXPECT_EQ(samplesAfter(passes, 0.97, std::sqrt(8)), 4u);
        EXPECT_EQ(samplesAfter(passes, 1.03, std::sqrt(8)), 8u);
    }
}

// Each pixel has no spread of its own, but they differ.
TEST(SampleAllotment, pixelsBesideAStepGetSamples) {
    std::array<SeenSamples, kPixels> atom;
    for (std::size_t i = 0; i < kPixels; ++i) {
        const double value = i % 8 < 4 ? 1.0 : 2.0;
        atom[i] = {4, {4 * value, 4 * value, 4 * value}, 4 * 3 * value * value};
    }
    std::array<std::uint16_t, kPixels> samples{};
    allotSamples(kRule, 2, atom, samples);
    for (std::size_t i = 0; i < kPixels; ++i)
        EXPECT_EQ(samples[i] > 1, i % 8 == 3 || i % 8 == 4) << i;
}

TEST(SampleAllotment, neighboursOfANoisyPixelGetSamplesToo) {
    auto atom = evenAtom(8, 1.0, 0.0);
    atom[3 * 8 + 3].square += 8 * 3 * 0.5;
    std::array<std::uint16_t, kPixels> samples{};
    allotSamples(kRule, 2, atom, samples);
    for (std::size_t i = 0; i < kPixels; ++i) {
        const auto dx = static_cast<int>(i % 8) - 3, dy = static_cast<int>(i / 8) - 3;
        if (std::abs(dx) > 1 || std::abs(dy) > 1)
            EXPECT_EQ(samples[i], 1u) << i;
        else
            EXPECT_EQ(samples[i], dx == 0 && dy == 0 ? 16u : 8u) << i;
    }
}

// An edge that a pixel's samples have met is taken to differ in light until they show that it
// doesn't, or others' do in an atom that is full of edges; where passes share no noise steps
// between means tell that.
TEST(SampleAllotment, edgesGetSamplesUntilTheyShowLittle) {
    const auto samplesAfter = [](double seen, std::size_t edges, const SampleRule& rule) {
        auto atom = evenAtom(seen, 1.0, 0.0);
        for (std::size_t i = 0; i < edges; ++i) atom[i].edges = 1;
        std::array<std::uint16_t, kPixels> samples{};
        allotSamples(rule, 1, atom, samples);
        for (std::size_t i = 1; i < kPixels; ++i)
            EXPECT_EQ(samples[i], i < edges ? samples[0] : rule.least) << i;
        return samples[0];
    };
    // Of a spread sqrt(2 v / (seen + 5)), v = 0.8 / (1 + seen edges / 128).
    EXPECT_EQ(samplesAfter(4, 1, kRule), 8);
    EXPECT_EQ(samplesAfter(4, 8, kRule), 8);
    EXPECT_EQ(samplesAfter(60, 8, kRule), 4);
    EXPECT_EQ(samplesAfter(1000, 8, kRule), 1);
    // 8 samples in place of 128.
    EXPECT_EQ(samplesAfter(4, kPixels, kRule), 4);
    EXPECT_EQ(samplesAfter(4, 8, kAlone), 1);
}

// What one pixel of an edge has met the others of it have as well.
TEST(SampleAllotment, edgesShareWhatTheyHaveMet) {
    auto atom = evenAtom(64, 1.0, 0.0);
    for (std::size_t i = 0; i < 16; ++i) atom[i].edges = 1;
    atom[0].square += 64 * 3 * 20.0;
    std::array<std::uint16_t, kPixels> samples{};
    allotSamples(kRule, 1, atom, samples);
    EXPECT_GT(samples[15], samples[40]);
    const auto met = samples[15];
    atom[0].square -= 64 * 3 * 20.0;
    allotSamples(kRule, 1, atom, samples);
    EXPECT_GT(met, samples[15]);
}

// An atom of two passes of four samples of mean 2, whose own relative variance is square, and whose
// passes have this one besides by what each shares.
std::array<SeenSamples, kPixels> twoPassesOfFour(double square, double shared) {
    auto atom = evenAtom(8, 2.0, 0.0);
    const double scale = 4.01;
    for (SeenSamples& seen : atom) {
        // What is expected of sums of squares: of 3 channels, within passes and between them.
        const double within = 6 * 3 * scale * square;
        const double between = 3 * scale * (square + 4 * shared);
        seen.ofPasses = 8 * 3 * 4.0 + between;
        seen.square = seen.ofPasses + within;
    }
    return atom;
}

TEST(AtomNoise, tellsWhatPassesShare) {
    // Less the standard error of a mean of 64 variances of one degree of freedom.
    const double error = std::sqrt(2.0 / 64) * 0.09 / 4;
    for (const double shared : {0.0, 1e-4, 0.01, 0.04})
        EXPECT_NEAR(AtomNoise(twoPassesOfFour(0.09, shared), {}).shared(4),
                    std::max(0.0, shared - error), 1e-12);
    // Pixels with edges don't count: sequences cure what their samples differ by.
    auto atom = twoPassesOfFour(0.09, 0.04);
    for (std::size_t i = 0; i < 32; ++i) {
        atom[i].edges = 1;
        atom[i].ofPasses = 8 * 3 * 4.0;
    }
    EXPECT_NEAR(AtomNoise(atom, {}).shared(4), 0.04 - error * std::sqrt(2.0), 1e-12);
    for (SeenSamples& seen : atom) seen.edges = 1;
    EXPECT_EQ(AtomNoise(atom, {}).shared(4), 0.0);
    // A single pass, or passes of a single sample, tell nothing; nor passes closer to each other
    // than by chance.
    EXPECT_EQ(AtomNoise(twoPassesOfFour(0.09, 0.04), {}).shared(8), 0.0);
    EXPECT_EQ(AtomNoise(twoPassesOfFour(0.09, 0.04), {}).shared(1), 0.0);
    EXPECT_EQ(AtomNoise(twoPassesOfFour(0.09, -0.02), {}).shared(4), 0.0);
}

// More samples of a pass don't lower what its photons make: there the threshold is no finer.
TEST(SampleAllotment, samplesDontGoWherePassesDifferByPhotons) {
    const SampleRule rule{4, 64, 0.01};
    const auto samplesAfter = [&rule](double shared, double spread) {
        std::array<std::uint16_t, kPixels> samples{};
        allotSamples(rule, 4, twoPassesOfFour(spread * spread, shared * shared), samples);
        return samples[20];
    };
    // sqrt(6 s / (0.04 / sqrt(8))), but at least the threshold 0.1: sqrt(6 s / 0.1).
    EXPECT_EQ(samplesAfter(0.0, 0.3), 8u);
    EXPECT_EQ(samplesAfter(0.01, 0.3), 8u);
    EXPECT_EQ(samplesAfter(0.1, 0.3), 4u);
    // Light that few samples meet gets some all the same.
    EXPECT_EQ(samplesAfter(0.5, 1.5), 8u);
    // It also hides what passes share.
    EXPECT_EQ(samplesAfter(0.1, 1.5), 32u);
    EXPECT_EQ(samplesAfter(0.0, 1.5), 32u);
}

TEST(SampleAllotment, oneSampleEachIsComparedWithItsNeighbours) {
    std::array<SeenSamples, kPixels> atom;
    for (std::size_t i = 0; i < kPixels; ++i) {
        const double value = i % 8 < 4 ? 1.0 : 2.0;
        atom[i] = {1, {value, value, value}, 3 * value * value};
    }
    std::array<std::uint16_t, kPixels> samples{};
    allotSamples(kRule, 2, atom, samples);
    for (std::size_t i = 0; i < kPixels; ++i) {
        const bool atEdge = i % 8 >= 2 && i % 8 <= 5;  // the step, and what is beside it
        EXPECT_EQ(samples[i] > 1, atEdge) << i;
    }
}

TEST(SampleAllotment, isDoneAfterEachPassOrWhereNothingIsSharedAfterOneTwoFour) {
    for (std::uint32_t passes = 1; passes < 70; ++passes) {
        const bool expected = passes == 1 || passes == 2 || passes == 4 || passes == 8 ||
                              passes == 16 || passes == 32 || passes == 64;
        EXPECT_EQ(allotsAfter(kAlone, passes), expected) << passes;
        EXPECT_TRUE(allotsAfter(kRule, passes));
    }
}

TEST(SampleAllotment, refusesRulesThatCannotBe) {
    EXPECT_THROW(checkSampleRule({4, 2, 0.01}), Error);
    EXPECT_THROW(checkSampleRule({0, 0, 0.01}), Error);
    EXPECT_THROW(checkSampleRule({1, 65536, 0.01}), Error);
    EXPECT_THROW(checkSampleRule({1, 64, 0.0}), Error);
}

}  // namespace
}  // namespace pm
