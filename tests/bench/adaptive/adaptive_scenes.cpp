// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "tests/bench/adaptive/adaptive_scenes.h"

#include <array>
#include <cmath>
#include <utility>

#include "tests/bench/plan/plan_scenes.h"
#include "tests/bench/run/bench_scenes.h"

namespace pm::bench {

namespace {

// A white plane that fills the frame, and one lamp high up on the side: every sample costs the
// same, and its noise is little.
test::SceneMaker plane() {
    test::SceneMaker maker;
    maker.quad({-2, -2, 0}, {4, 0, 0}, {0, 4, 0}, maker.diffuse(Rgb(0.7f)));
    maker.quad({-0.75, 7.5, 6}, {0, 1, 0}, {1.5, 0, 0}, maker.diffuse({}, Rgb(40.0f)));
    maker.camera({0, 0, 4}, {0, 0, 0}, {0, 1, 0}, 28);
    return maker;
}

// Black bars between lamp and plane, out of the camera's sight: within their shadow every sample
// sees the lamp or does not. covered: the bars' share. x0, x1, y0, y1: of the shadow, on the plane,
// where the frame spans -1 to 1. The bars lie at z = 1: towards the lamp a point moves by a sixth
// of the way.
void addBars(test::SceneMaker& maker, double covered, double x0, double x1, double y0, double y1) {
    const auto black = maker.diffuse({});
    const auto onBars = [](double at, double lamp) { return at + (lamp - at) / 6; };
    const double left = onBars(x0, 0), right = onBars(x1, 0);
    const double low = onBars(y0, 8), high = onBars(y1, 8);
    constexpr double kApart = 0.06;
    for (double x = left; x < right; x += kApart)
        maker.quad({x, low, 1}, {kApart * covered, 0, 0}, {0, high - low, 0}, black);
}

test::SceneMaker barsEverywhere() {
    test::SceneMaker maker = plane();
    addBars(maker, 0.5, -1.5, 1.5, -1.2, 1.2);
    return maker;
}

test::SceneMaker barsInAQuarter() {
    test::SceneMaker maker = plane();
    addBars(maker, 0.75, 0.1, 1.5, 0.1, 1.2);
    return maker;
}

// The plane with black specks, count to a side of a square from (low, low) on, where whether a
// sample meets one no lamp sample tells.
test::SceneMaker specks(double low, double apart, double side, int count) {
    test::SceneMaker maker = plane();
    const auto black = maker.diffuse({});
    constexpr double kAbove = 1e-4;
    for (int j = 0; j < count; ++j)
        for (int i = 0; i < count; ++i) {
            // Anywhere in its cell, by the fractions of two irrational multiples.
            const double n = j * count + i;
            const double x = i + std::fmod(0.7548776662 * n, 1.0) * (1 - side / apart);
            const double y = j + std::fmod(0.5698402910 * n, 1.0) * (1 - side / apart);
            maker.quad({low + apart * x, low + apart * y, kAbove}, {side, 0, 0}, {0, side, 0},
                       black);
        }
    return maker;
}

// Shining shapes, many times larger than a pixel, on black: nothing but edges is noisy.
test::SceneMaker edges() {
    test::SceneMaker maker;
    for (int i = 0; i < 12; ++i) {
        const double angle = 0.4 + 0.5 * i, x = std::cos(2.4 * i) * 0.7,
                     y = std::sin(1.7 * i) * 0.7;
        const float shine = 0.2f + 0.07f * static_cast<float>(i);
        const Vec3d along{0.4 * std::cos(angle), 0.4 * std::sin(angle), 0};
        const Vec3d across{-0.25 * std::sin(angle), 0.25 * std::cos(angle), 0};
        maker.quad({x, y, 0.01 * i}, along, across, maker.diffuse({}, Rgb(shine)));
    }
    maker.camera({0, 0, 4}, {0, 0, 0}, {0, 1, 0}, 28);
    return maker;
}

// Shining lines on black, a quarter as wide as a pixel.
test::SceneMaker lines() {
    test::SceneMaker maker;
    const auto shining = maker.diffuse({}, Rgb(1.0f));
    for (int i = 0; i < 14; ++i) {
        const double angle = 0.45 * i, x = std::cos(2.4 * i) * 0.6, y = std::sin(1.7 * i) * 0.6;
        const Vec3d along{std::cos(angle), std::sin(angle), 0};
        const Vec3d across{-0.008 * std::sin(angle), 0.008 * std::cos(angle), 0};
        maker.quad({x - along.x / 2, y - along.y / 2, 0.01 * i}, along, across, shining);
    }
    maker.camera({0, 0, 4}, {0, 0, 0}, {0, 1, 0}, 28);
    return maker;
}

// In a box from -1 to 1.
void addLampAndCamera(test::SceneMaker& maker) {
    maker.quad({-0.5, 0.99, 0.3}, {1, 0, 0}, {0, 0, 0.5}, maker.diffuse({}, Rgb(6.0f)));
    maker.camera({0, 0, 0.9}, {0, -0.2, -1}, {0, 1, 0}, 50);
}

// A closed white box from within: light from everywhere, photons in each pass, no edge but corners.
test::SceneMaker whiteBox() {
    test::SceneMaker maker;
    maker.box({-1, -1, -1}, {1, 1, 1}, maker.diffuse(Rgb(0.6f)), true);
    addLampAndCamera(maker);
    return maker;
}

// The same of tiles below a pixel, of two materials that look alike: edges everywhere, and nothing
// to see at them.
test::SceneMaker tiledBox() {
    test::SceneMaker maker;
    const std::array<std::uint32_t, 2> materials = {maker.diffuse(Rgb(0.6f)),
                                                    maker.diffuse(Rgb(0.6f))};
    constexpr int kTiles = 128;
    // Faces inwards: a right-handed pair of edges, whose cross product points in.
    const auto tile = [&](const Vec3d& corner, const Vec3d& across, const Vec3d& along) {
        for (int j = 0; j < kTiles; ++j)
            for (int i = 0; i < kTiles; ++i)
                maker.quad(corner + across * (i / double{kTiles}) + along * (j / double{kTiles}),
                           across * (1 / double{kTiles}), along * (1 / double{kTiles}),
                           materials[static_cast<std::size_t>((i + j) % 2)]);
    };
    tile({-1, -1, -1}, {0, 0, 2}, {2, 0, 0});
    tile({-1, 1, -1}, {2, 0, 0}, {0, 0, 2});
    tile({-1, -1, -1}, {2, 0, 0}, {0, 2, 0});
    tile({-1, -1, 1}, {0, 2, 0}, {2, 0, 0});
    tile({-1, -1, -1}, {0, 2, 0}, {0, 0, 2});
    tile({1, -1, -1}, {0, 0, 2}, {0, 2, 0});
    addLampAndCamera(maker);
    return maker;
}

}  // namespace

std::vector<AdaptiveScene> adaptiveScenes(const std::filesystem::path& peers) {
    std::vector<AdaptiveScene> scenes = {
        {"plane", "a plane under a lamp: little noise, everywhere alike", plane(), true},
        {"bars", "the same in the shadow of bars: much noise, everywhere alike", barsEverywhere(),
         true},
        {"whitebox", "a closed white box: indirect light", whiteBox(), true},
        {"tiles", "the white box of two materials that look alike: edges everywhere", tiledBox(),
         true},
        {"edges", "shining shapes on black: edges only", edges(), true},
        {"quarter", "the plane, light through slits on a quarter of it", barsInAQuarter(), true},
        {"quarter-fine", "the plane, black specks far below a pixel on a quarter of it",
         specks(0, 0.009, 0.004, 112), true},
        {"rare", "the plane, black specks far below a pixel on 3 % of it",
         specks(-1.1, 0.018, 0.0031, 122), true},
        {"lines", "shining lines thinner than a pixel on black", lines(), true}};
    for (PlanScene& scene : planScenes())
        scenes.push_back({scene.key, scene.what, std::move(scene.maker), scene.byPaths});
    const std::filesystem::path file = peers / "scenes.json";
    if (!std::filesystem::exists(file)) return scenes;
    for (const char* const key : {"A", "B", "C"}) {
        const NeutralScene neutral = readNeutralScene(file, key);
        scenes.push_back(
            {neutral.name, "neutral", makeNeutralScene(neutral), neutral.name != "sds"});
    }
    return scenes;
}

}  // namespace pm::bench
