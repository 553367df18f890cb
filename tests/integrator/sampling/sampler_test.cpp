// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// The sampler's points: stratified as a (0,2)-sequence, uniform, a pure function of their names;
// and the pinned functions against the C library's.
#include "integrator/sampling/sampler.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <utility>
#include <vector>

#include "integrator/sampling/pinned_math.h"
#include "tests/support/statistics.h"

namespace pm::test {
namespace {

constexpr double kSignificance = 1e-4;

std::vector<Vec2f> pairOfDimensions(std::uint64_t sequence, int pair, std::uint32_t count) {
    std::vector<Vec2f> points;
    for (std::uint32_t i = 0; i < count; ++i) {
        Sampler sampler(7, 3, sequence, i);
        for (int event = 0; event < pair / 2; ++event) sampler.nextEvent();
        points.push_back(sampler.get2D(pair % 2 ? Purpose::kDirection : Purpose::kDirect));
    }
    return points;
}

// True when every box of 2^-a by 2^-b, a + b = log2(count), holds exactly one point.
bool isNet(const std::vector<Vec2f>& points, int log2Count) {
    for (int a = 0; a <= log2Count; ++a) {
        const float sx = std::ldexp(1.0f, a), sy = std::ldexp(1.0f, log2Count - a);
        std::set<std::pair<int, int>> boxes;
        for (const Vec2f& p : points)
            boxes.insert({static_cast<int>(p.x * sx), static_cast<int>(p.y * sy)});
        if (boxes.size() != points.size()) return false;
    }
    return true;
}

TEST(Sampler, EveryPairOfDimensionsIsANet) {
    for (std::uint64_t sequence = 0; sequence < 8; ++sequence)
        for (int pair = 0; pair < 4; ++pair)
            for (int k = 1; k <= 5; ++k)
                EXPECT_TRUE(isNet(pairOfDimensions(sequence, pair, 1u << (2 * k)), 2 * k))
                    << "sequence " << sequence << " pair " << pair << " of 4^" << k;
}

// Any aligned block of a sequence is a net too: passes and pixels may take it in parts.
TEST(Sampler, LaterBlocksAreNets) {
    const std::vector<Vec2f> points = pairOfDimensions(5, 1, 256);
    for (std::ptrdiff_t block = 0; block < 4; ++block)
        EXPECT_TRUE(isNet({points.begin() + 64 * block, points.begin() + 64 * (block + 1)}, 6));
}

TEST(Sampler, IndependentPointsAreNoNet) {
    Random random(1);
    std::vector<Vec2f> points;
    for (int i = 0; i < 256; ++i) points.push_back(random.next2D());
    EXPECT_FALSE(isNet(points, 8));
}

TEST(Sampler, OneDimensionIsStratified) {
    for (std::uint64_t sequence = 0; sequence < 8; ++sequence) {
        std::vector<int> seen(1024);
        for (std::uint32_t i = 0; i < 1024; ++i) {
            const Sampler sampler(1, 0, sequence, i);
            ++seen[static_cast<std::size_t>(sampler.get1D(Purpose::kLobe) * 1024.0f)];
        }
        EXPECT_EQ(*std::max_element(seen.begin(), seen.end()), 1);
    }
}

// The same point of many sequences, seeds, streams: as good as independent random numbers.
TEST(Sampler, UniformAcrossNames) {
    const auto flat = [](double, double) { return 1.0; };
    for (int varied = 0; varied < 3; ++varied) {
        std::uint64_t n = 0;
        const double p = squarePValue(
            100'000,
            [&]() -> std::optional<Vec2f> {
                ++n;
                return Sampler(varied == 0 ? n : 1, varied == 1 ? n : 0, varied == 2 ? n : 0, 5)
                    .get2D(Purpose::kDirection);
            },
            flat);
        EXPECT_GT(p, kSignificance) << "varied: " << varied;
    }
}

// Numbers of other purposes, events and branches, and neighbours in sequence and stream, know
// nothing of each other.
TEST(Sampler, PairsAndNeighboursAreIndependent) {
    for (int kind = 0; kind < 7; ++kind) {
        std::uint64_t n = 0;
        const double p = squarePValue(
            100'000,
            [&]() -> std::optional<Vec2f> {
                ++n;
                const Sampler first(1, 2, n, 0);
                Sampler second(1, kind == 1 ? 4 : 2, kind == 2 ? n + (1ull << 32) : n, 0);
                if (kind == 3) second.nextEvent();
                if (kind == 4) second = first.branch(0);
                if (kind == 5) second = first.branch(1);
                const Sampler& other = kind == 6 ? first.branch(0) : first;
                const Purpose purpose = kind == 0 ? Purpose::kDirect : Purpose::kLobe;
                const Sampler last = kind == 6 ? first.branch(1) : second;
                return Vec2f{other.get1D(Purpose::kLobe), last.get1D(purpose)};
            },
            [](double, double) { return 1.0; });
        EXPECT_GT(p, kSignificance) << "kind: " << kind;
    }
}

TEST(Sampler, IsAPureFunctionOfItsArguments) {
    const std::vector<Vec2f> forwards = pairOfDimensions(9, 2, 512);
    for (std::uint32_t i = 512; i-- > 0;) {
        Sampler sampler(7, 3, 9, i);
        sampler.nextEvent();
        EXPECT_EQ(sampler.get2D(Purpose::kDirect), forwards[i]);
    }
    EXPECT_NE(forwards, pairOfDimensions(10, 2, 512));
}

// From one point of a sequence to another is as good as a sampler of its own.
TEST(Sampler, AnotherPointOfTheSequence) {
    const Sampler used(3, 5, 7, 11);
    for (const std::uint32_t index : {0u, 1u, 11u, 0x80000001u}) {
        Sampler other = used.at(index), own(3, 5, 7, index);
        for (int i = 0; i < 4; ++i, other.nextEvent(), own.nextEvent()) {
            EXPECT_EQ(other.get1D(Purpose::kLobe), own.get1D(Purpose::kLobe)) << index;
            EXPECT_EQ(other.get2D(Purpose::kLobe), own.get2D(Purpose::kLobe)) << index;
        }
    }
}

// What was asked for before, and for what, changes no number.
TEST(Sampler, PurposesAreKeysNotAnOrder) {
    Sampler plain(3, 5, 7, 11), asked(3, 5, 7, 11);
    for (int event = 0; event < 3; ++event, plain.nextEvent(), asked.nextEvent()) {
        asked.get1D(Purpose::kRoulette);
        asked.get2D(Purpose::kLens);
        asked.branch(2).get2D(Purpose::kDirection);
        EXPECT_EQ(plain.get2D(Purpose::kDirection), asked.get2D(Purpose::kDirection)) << event;
        EXPECT_EQ(plain.branch(1).get1D(Purpose::kLobe), asked.branch(1).get1D(Purpose::kLobe));
    }
}

TEST(PinnedMath, SinCosTurns) {
    double worst = 0;
    for (int i = 0; i <= 1 << 20; ++i) {
        const float turns = static_cast<float>(i) * 0x1p-20f;
        const SinCos sc = sinCosTurns(turns);
        const double angle = 2 * std::numbers::pi * static_cast<double>(turns);
        worst = std::max({worst, std::abs(static_cast<double>(sc.sin) - std::sin(angle)),
                          std::abs(static_cast<double>(sc.cos) - std::cos(angle))});
    }
    EXPECT_LE(worst, 0x1p-25 + 1e-13);  // half of the last place of a float below 1
}

TEST(PinnedMath, LogarithmAndPower) {
    Random random(2);
    double worstLog = 0, worstExp = 0, worstPow = 0;
    for (int i = 0; i < 200'000; ++i) {
        const double u = static_cast<double>(random.next()), v = static_cast<double>(random.next());
        const double x = i % 2 ? std::exp2(2000 * u - 1000) : 1 + 1e-3 * (u - 0.5);
        if (x != 1) worstLog = std::max(worstLog, std::abs(pinnedLog2(x) / std::log2(x) - 1));
        const double e = 2044 * v - 1022;
        worstExp = std::max(worstExp, std::abs(pinnedExp2(e) / std::exp2(e) - 1));
        const float base = static_cast<float>(u), exponent = static_cast<float>(100 * v * v * v);
        const double power = std::pow(static_cast<double>(base), static_cast<double>(exponent));
        if (power > 1e-37)
            worstPow = std::max(
                worstPow, std::abs(static_cast<double>(pinnedPow(base, exponent)) / power - 1));
    }
    EXPECT_LT(worstLog, 1e-13);
    EXPECT_LT(worstExp, 1e-13);
    EXPECT_LT(worstPow, 0x1p-24 + 1e-11);
    EXPECT_EQ(pinnedPow(0.0f, 0.0f), 1.0f);
    EXPECT_EQ(pinnedPow(0.0f, 2.0f), 0.0f);
    EXPECT_EQ(pinnedPow(1.0f, 1e30f), 1.0f);
    EXPECT_EQ(pinnedPow(0.5f, 1e30f), 0.0f);
    EXPECT_EQ(pinnedExp2(-1e300), 0.0);
}

}  // namespace
}  // namespace pm::test
