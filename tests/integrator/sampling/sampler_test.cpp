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
        for (int skipped = 0; skipped < pair; ++skipped) sampler.next2D();
        points.push_back(sampler.next2D());
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
            Sampler sampler(1, 0, sequence, i);
            sampler.next2D();
            ++seen[static_cast<std::size_t>(sampler.next1D() * 1024.0f)];
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
                Sampler sampler(varied == 0 ? n : 1, varied == 1 ? n : 0, varied == 2 ? n : 0, 5);
                sampler.next1D();
                return sampler.next2D();
            },
            flat);
        EXPECT_GT(p, kSignificance) << "varied: " << varied;
    }
}

// Dimensions of different pairs, and neighbours in sequence and stream, know nothing of each other.
TEST(Sampler, PairsAndNeighboursAreIndependent) {
    for (int kind = 0; kind < 3; ++kind) {
        std::uint64_t n = 0;
        const double p = squarePValue(
            100'000,
            [&]() -> std::optional<Vec2f> {
                ++n;
                Sampler first(1, 2, n, 0);
                const float x = first.next2D().x;
                if (kind == 0) return Vec2f{x, first.next2D().x};
                Sampler second(1, kind == 1 ? 4 : 2, kind == 2 ? n + (1ull << 32) : n, 0);
                return Vec2f{x, second.next2D().x};
            },
            [](double, double) { return 1.0; });
        EXPECT_GT(p, kSignificance) << "kind: " << kind;
    }
}

TEST(Sampler, IsAPureFunctionOfItsArguments) {
    const std::vector<Vec2f> forwards = pairOfDimensions(9, 2, 512);
    for (std::uint32_t i = 512; i-- > 0;) {
        Sampler sampler(7, 3, 9, i);
        sampler.next2D();
        sampler.next2D();
        EXPECT_EQ(sampler.next2D(), forwards[i]);
    }
    EXPECT_NE(forwards, pairOfDimensions(10, 2, 512));
    // Stored once: a change of these is a change of every picture.
    Sampler sampler(1, 2, 3, 4);
    const float x = sampler.next1D();
    Sampler again(1, 2, 3, 4);
    EXPECT_EQ(x, again.next1D());
    EXPECT_GE(x, 0.0f);
    EXPECT_LT(x, 1.0f);
}

// From one point of a sequence to another is as good as a sampler of its own.
TEST(Sampler, AnotherPointOfTheSequence) {
    Sampler used(3, 5, 7, 11);
    used.next2D();
    for (const std::uint32_t index : {0u, 1u, 11u, 0x80000001u}) {
        Sampler other = used.at(index), own(3, 5, 7, index);
        for (int i = 0; i < 4; ++i) {
            EXPECT_EQ(other.next1D(), own.next1D()) << index;
            EXPECT_EQ(other.next2D(), own.next2D()) << index;
        }
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
