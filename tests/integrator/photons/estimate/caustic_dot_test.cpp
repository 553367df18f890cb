// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Light that falls within much less than a pixel is all there: a spot's narrow cone, through a
// pane, on a wall. Of what falls on smooth glass squarely R = ((n - 1) / (n + 1))^2 is reflected at
// either face, to and fro: (1 - R) / (1 + R) goes through.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/support/scene_maker.h"

namespace pm::test {
namespace {

constexpr int kSide = 32;
constexpr double kEye = 3.0, kWall = 1.0, kReflectance = 0.5, kIor = 1.5;

// A wall in the plane z = 0 that fills the frame, and before it the lamp (1 W) with its pane, which
// stands in no pixel's way to the dot.
SceneMaker wallWithDot(double angle) {
    SceneMaker maker;
    maker.quad({-2 * kWall, -2 * kWall, 0}, {4 * kWall, 0, 0}, {0, 4 * kWall, 0},
               maker.diffuse(Rgb(static_cast<float>(kReflectance))));
    MaterialDescription glass;
    glass.kind = MaterialKind::kDielectric;
    glass.ior = static_cast<float>(kIor);
    maker.box({0.37, -0.03, 0.8}, {0.43, 0.03, 0.81}, maker.material(glass), false);
    const double half = std::sin(0.5 * angle);
    const double solidAngle = 4 * std::numbers::pi * half * half;
    maker.spot({0.4, 0.003, 1}, {0, 0, -1}, Rgb(static_cast<float>(1 / solidAngle)), angle, 0);
    maker.camera({0, 0, kEye}, {0, 0, 0}, {0, 1, 0},
                 2 * std::atan(kWall / kEye) * 180 / std::numbers::pi);
    return maker;
}

// Over what is expected, by renders of several seeds.
double shareOfFlux(double angle, std::uint32_t passes) {
    constexpr int kSeeds = 6;
    const double r = std::pow((kIor - 1) / (kIor + 1), 2), expected = (1 - r) / (1 + r);
    const auto scene = wallWithDot(angle).build();
    double sum = 0;
    for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
        RenderSettings settings = smallFrame(kSide, kSide, IntegratorKind::kPhoton, passes, 3);
        settings.photons = 4000;
        settings.seed = seed;
        sum += measure(scene, settings).caustic.mean[0];
    }
    // The frame shows kWall to either side; radiance is the reflectance over pi times irradiance.
    return sum / kSeeds * 4 * kWall * kWall * std::numbers::pi / kReflectance / expected;
}

TEST(CausticDot, KeepsItsFluxHoweverSmall) {
    for (const double angle : {1e-2, 1e-4, 1e-7})
        for (const std::uint32_t passes : {1u, 4u}) {
            const double share = shareOfFlux(angle, passes);
            fmt::print("    {} radians, {} passes: {:.4f}\n", angle, passes, share);
            // A render's varies by 5 % in one pass, by the places of the samples alone.
            EXPECT_NEAR(share, 1, 0.05) << angle << " radians, " << passes << " passes";
        }
}

}  // namespace
}  // namespace pm::test
