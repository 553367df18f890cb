// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// How bright a pilot finds a picture: closed forms, and what it must not depend on.
#include "integrator/transport/survey/error_scale_pilot.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "tests/support/rooms.h"
#include "tests/support/scene_maker.h"

namespace pm::test {
namespace {

constexpr double kPiD = 3.14159265358979323846;

RenderSettings frame() {
    return smallFrame(48, 32, IntegratorKind::kPhoton, 2, 2);
}

// Of a rendering space of linear Rec.709; without one there is no luminance.
std::shared_ptr<const Scene> build(SceneMaker& maker) {
    maker.description.rgbToXyz = {0.4124, 0.3576, 0.1805, 0.2126, 0.7152,
                                  0.0722, 0.0193, 0.1192, 0.9505};
    return maker.build();
}

float times(float value, int stops) {
    return std::ldexp(value, stops);
}

std::shared_ptr<const Scene> roomOf(int stops) {
    SceneMaker maker = openRoom();
    ceilingLamp(maker, 0.25, Rgb(times(5, stops), times(4, stops), times(3, stops)));
    return build(maker);
}

// A wall in the sun fills the frame; of its width the left part is covered by a lamp that shines as
// bright as 2^stops.
std::shared_ptr<const Scene> wallInTheSun(double radiance, double lampShare, int stops = 0) {
    SceneMaker maker;
    const std::uint32_t grey = maker.diffuse(Rgb(0.5f));
    maker.quad({-3, -3, 0}, {6, 0, 0}, {0, 6, 0}, grey);
    maker.sun({0, 0, -1}, Rgb(static_cast<float>(radiance * kPiD / 0.5)), 0.0);
    const double half = std::tan(20 * kPiD / 180) * 2.9;  // of the frame's height at the lamp
    if (lampShare > 0)
        maker.quad({-1.5 * half, -2, 0.1}, {3 * half * lampShare, 0, 0}, {0, 4, 0},
                   maker.diffuse({}, Rgb(times(1, stops))));
    maker.camera({0, 0, 3}, {0, 0, 0}, {0, 1, 0}, 40);
    return build(maker);
}

TEST(ErrorScalePilot, BringsAnEvenWallToMiddleGrey) {
    for (const int stops : {-30, -12, -4, 0, 3, 9, 25})
        for (const double off : {-0.4, 0.0, 0.4})
            EXPECT_EQ(stopsToMiddleGrey(*wallInTheSun(0.18 * std::exp2(off - stops), 0), frame()),
                      stops)
                << off;
}

// It is light on surfaces that errors are of; only where next to nothing else is seen, lamps.
TEST(ErrorScalePilot, LampsAreNotMetered) {
    EXPECT_EQ(stopsToMiddleGrey(*wallInTheSun(0.18 / 1024, 0.5, 6), frame()), 10);
    const auto all = stopsToMiddleGrey(*wallInTheSun(0.18 / 1024, 0.97, 6), frame());
    EXPECT_LE(all, -5);  // 2 / 2^6, the highlights' limit
}

// To the bit: a lamp 2^k times as bright.
TEST(ErrorScalePilot, IsOfTheUnit) {
    const std::int32_t stops = stopsToMiddleGrey(*roomOf(0), frame());
    for (int k = -24; k <= 24; k += 3)
        EXPECT_EQ(stopsToMiddleGrey(*roomOf(k), frame()), stops - k) << k;
    EXPECT_EQ(stopsToMiddleGrey(*roomOf(-60), frame()), ErrorScale::kMostStops);
    EXPECT_EQ(stopsToMiddleGrey(*roomOf(60), frame()), -ErrorScale::kMostStops);
}

// What is near to a middle grey keeps its bits.
TEST(ErrorScalePilot, NearAMiddleGreyItIsNone) {
    const std::int32_t stops = stopsToMiddleGrey(*roomOf(0), frame());
    for (int left = -6; left <= 6; ++left)
        EXPECT_EQ(findErrorScale(*roomOf(stops - left), frame()).stops(),
                  std::abs(left) <= kNeutralStops ? 0 : left);
}

// Light through a smooth pane, which few paths find, is no darkness.
TEST(ErrorScalePilot, SeldomLightIsLight) {
    const auto inGlass = [](bool isInGlass) {
        SceneMaker maker = openRoom();
        ceilingLamp(maker, 0.15, Rgb(20.0f));
        if (isInGlass)
            maker.quad({-0.95, 0.9, -0.95}, {0, 0, 1.9}, {1.9, 0, 0}, maker.material([] {
                MaterialDescription pane = glass(1.0001f);
                return pane;
            }()));
        return stopsToMiddleGrey(*build(maker), frame());
    };
    EXPECT_NEAR(inGlass(true), inGlass(false), 1);
}

TEST(ErrorScalePilot, DependsOnTheFrameAlone) {
    const auto scene = roomOf(-9);
    const ErrorScale scale = findErrorScale(*scene, frame());
    EXPECT_NE(scale.stops(), 0);
    RenderSettings other = frame();
    other.seed = 77;
    other.passes = 9;
    other.window = {8, 8, 16, 16};
    other.integrator = IntegratorKind::kPath;
    other.aaLevel = 5;
    EXPECT_EQ(findErrorScale(*scene, other), scale);
    EXPECT_EQ(makePlan(*scene, frame()).errorScale, scale);
    EXPECT_EQ(makePlan(*scene, other).errorScale, scale);
    other.errorScale = ErrorScale(2);
    EXPECT_EQ(makePlan(*scene, other).errorScale.stops(), 2);
}

TEST(ErrorScalePilot, WithoutLightItIsNone) {
    SceneMaker maker = openRoom();
    EXPECT_EQ(findErrorScale(*build(maker), frame()), ErrorScale());
    // A lamp that shines away from all that is seen.
    maker.quad({-9, 0, -9}, {1, 0, 0}, {0, -1, 0}, maker.diffuse({}, Rgb(1e-4f)));
    EXPECT_EQ(findErrorScale(*build(maker), frame()), ErrorScale());
}

}  // namespace
}  // namespace pm::test
