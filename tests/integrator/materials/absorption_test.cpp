// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Glass that absorbs, against the closed form of a slab with all its internal reflections.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/scene_maker.h"

namespace pm::test {
namespace {

MaterialDescription absorbing(Rgb left, float distance) {
    MaterialDescription m;
    m.kind = MaterialKind::kDielectric;
    m.attenuationColour = left;
    m.attenuationDistance = distance;
    return m;
}

// At normal incidence R = .04 at each side, and tau is left of a way through:
// T = (1 - R)^2 tau / (1 - R^2 tau^2).
double slab(double tau) {
    constexpr double kR = 0.04;
    return (1 - kR) * (1 - kR) * tau / (1 - kR * kR * tau * tau);
}

TEST(Absorption, SlabInFrontOfALamp) {
    EXPECT_NEAR(slab(0.5), 0.460984, 1e-6);
    for (const auto integrator : {IntegratorKind::kPath, IntegratorKind::kPhoton})
        for (const float thickness : {0.5f, 1.0f, 2.0f}) {
            SceneMaker maker;
            // Half of the red, a quarter of the green and all of the blue after 1.
            const auto glass = maker.material(absorbing({0.5f, 0.25f, 1.0f}, 1.0f));
            maker.box({-4, -4, -thickness}, {4, 4, 0}, glass, false);
            maker.quad({-4, -4, -5}, {8, 0, 0}, {0, 8, 0}, maker.diffuse({}, Rgb(1.0f)));
            maker.camera({0, 0, 30}, {0, 0, 0}, {0, 1, 0}, 0.2);
            RenderSettings settings = smallFrame(8, 8, integrator, 16, 5);
            settings.photons = 1000;
            const Measured found = measure(maker.build(), settings).beauty;
            const double t = static_cast<double>(thickness);
            const Rgb right{static_cast<float>(slab(std::pow(0.5, t))),
                            static_cast<float>(slab(std::pow(0.25, t))),
                            static_cast<float>(slab(1.0))};
            EXPECT_TRUE(agrees(found, right, 1e-3)) << fmt::format("thickness {}", thickness);
        }
}

// A parallel light through a slab onto a floor: the caustic is what it lets through, by photons as
// by the formula.
TEST(Absorption, PhotonsLoseTheSame) {
    SceneMaker maker;
    const auto glass = maker.material(absorbing({0.5f, 0.25f, 1.0f}, 1.0f));
    maker.box({-1, 0.5, -1}, {1, 1.5, 1}, glass, false);
    maker.quad({-1, 0, 1}, {2, 0, 0}, {0, 0, -2}, maker.diffuse(Rgb(0.5f)));
    maker.sun({0, -1, 0}, Rgb(2.0f), 0);
    maker.camera({0, 0.45, 0.01}, {0, 0, 0}, {0, 0, -1}, 60);
    RenderSettings settings = smallFrame(8, 8, IntegratorKind::kPhoton, 16, 3);
    settings.photons = 60'000;
    const Measured found = measure(maker.build(), settings, {2, 2, 6, 6}).caustic;
    const auto radiance = [](double tau) {
        return static_cast<float>(0.5 / 3.14159265358979 * 2 * slab(tau));
    };
    EXPECT_TRUE(agrees(found, {radiance(0.5), radiance(0.25), radiance(1)}, 0.02));
}

TEST(Absorption, WithoutADistanceThereIsNone) {
    EXPECT_FALSE(absorbs(absorbing({0.5f, 0.5f, 0.5f}, 0)));
    EXPECT_FALSE(absorbs(absorbing(Rgb(1.0f), 1)));
    EXPECT_TRUE(absorbs(absorbing({1, 1, 0.5f}, 1)));
}

}  // namespace
}  // namespace pm::test
