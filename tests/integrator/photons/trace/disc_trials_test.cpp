// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Which discs win on a plane whose light is known: the widest where it is even, narrow ones where
// it lies in lines, both side by side, and the widest where there are no two halves to compare.
#include "integrator/photons/trace/disc_trials.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <vector>

#include "integrator/photons/estimate/caustic_map.h"
#include "tests/support/statistics.h"

namespace pm::test {
namespace {

constexpr std::size_t kCount = 40'000;
constexpr std::uint32_t kSought = 80;
// Lines so far apart, and so wide; the widest discs have a radius of about 0.0126.
constexpr float kSpacing = 0.02f, kWidth = 0.002f;

// Of the unit square, where a photon goes that would land evenly; either half is all the light.
using Bend = std::function<Vec2f(Vec2f)>;

std::vector<Photon> pilotOf(const Bend& bend, std::uint64_t seed, bool inHalves = true) {
    std::vector<Photon> photons;
    Random random(seed);
    for (std::size_t i = 0; i < kCount; ++i) {
        const Vec2f at = bend(random.next2D());
        PackedNormal normal(Vec3f{0, 0, 1});
        if (inHalves && i % 2 == 1) normal.mark();
        photons.push_back({{at.x, at.y, 0}, Rgb(1.0f / kCount), normal});
    }
    return photons;
}

Vec2f evenly(Vec2f u) {
    return u;
}

Vec2f inLines(Vec2f u) {
    const float line = std::floor(u.x / kSpacing);
    return {kSpacing * line + kWidth * (u.x / kSpacing - line), u.y};
}

// Mean radius over what even light is given, left and right of the middle.
struct Sides {
    double left = 0, right = 0;
};

Sides radiiOf(const Bend& bend, bool inHalves = true) {
    const PilotRadius radius(pilotOf(bend, 1, inHalves), kSought, 0.1f);
    const double ofEven = std::sqrt(kSought / PilotRadius::kPilotShare / (kPi * kCount));
    NearestPhotons scratch;
    Sides sides;
    constexpr int kPlaces = 4000;
    Random random(2);
    for (int i = 0; i < kPlaces; ++i) {
        const Vec2f u = random.next2D();
        const bool isLeft = i % 2 == 0;
        const Vec2f at = bend({0.05f + 0.4f * u.x + (isLeft ? 0.0f : 0.5f), 0.1f + 0.8f * u.y});
        (isLeft ? sides.left : sides.right) +=
            static_cast<double>(radius.at({at.x, at.y, 0}, {0, 0, 1}, scratch)) / ofEven /
            (0.5 * kPlaces);
    }
    fmt::print("    radius {:.3f} on the left, {:.3f} on the right\n", sides.left, sides.right);
    return sides;
}

TEST(DiscTrials, EvenLightHasWideDiscs) {
    const Sides sides = radiiOf(evenly);
    EXPECT_NEAR(sides.left, 0.95, 0.1);
    EXPECT_NEAR(sides.right, 0.95, 0.1);
}

TEST(DiscTrials, LinesHaveNarrowDiscs) {
    const Sides sides = radiiOf(inLines);
    EXPECT_LT(sides.left, 0.35);
    EXPECT_LT(sides.right, 0.35);
}

TEST(DiscTrials, EachRegionHasItsOwn) {
    const Sides sides = radiiOf([](Vec2f u) { return u.x < 0.5f ? evenly(u) : inLines(u); });
    EXPECT_GT(sides.left, 0.75);
    EXPECT_LT(sides.right, 0.35);
}

// Halves that are not told apart tell nothing.
TEST(DiscTrials, WithoutHalvesAllDiscsAreWide) {
    EXPECT_GT(radiiOf(inLines, false).left, 0.4);
}

}  // namespace
}  // namespace pm::test
