// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Shares of discs at edges and corners against their closed forms.
#include "integrator/photons/surface_patch.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/integrator/scene_maker.h"
#include "tests/integrator/statistics.h"

namespace pm::test {
namespace {

constexpr float kRadius = 0.05f;

// Of a disc of radius 1 the part within a straight edge at a distance from its middle.
double shareAtEdge(double away) {
    const double segment = std::acos(away) - away * std::sqrt(1 - away * away);
    return 1 - segment / std::numbers::pi;
}

// A plate's edge along the axes of the grid, where roundings that were the same in all squares
// would add up: within 5 % everywhere, as at all edges, and less than 1 % off in the mean.
TEST(SurfacePatch, SharesAtEdgesAlongTheGrid) {
    SceneMaker maker;
    maker.quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, maker.diffuse(Rgb(0.5f)));
    const auto scene = maker.build();
    Random random(3);
    double sum = 0, worst = 0;
    int count = 0;
    for (int i = 0; i < 400; ++i) {
        const float above = random.next() * 0.75f, along = random.next() * 1.5f - 0.75f;
        const Vec3f site{0.3f * random.next(), -1.0f + above * kRadius, 0};
        const SurfacePatch patch(*scene, site, {0, 0, 1}, kRadius, static_cast<std::uint64_t>(i));
        ASSERT_FALSE(patch.isWhole());
        const float radius = 0.5f + 0.5f * random.next(), away = radius * random.next();
        if (std::abs(away - above) > 0.75f) continue;
        const Vec3f middle{site.x + along * kRadius, -1.0f + away * kRadius, 0};
        ASSERT_TRUE(patch.speaksFor(*scene, middle, {0, 0, 1}));
        const auto shares = patch.shares(middle, radius * kRadius);
        const double error =
            static_cast<double>(shares.wide) / shareAtEdge(static_cast<double>(away / radius)) - 1;
        sum += error;
        worst = std::max(worst, std::abs(error));
        ++count;
    }
    fmt::print("    mean error {:+.4f}, worst {:.3f}\n", sum / count, worst);
    EXPECT_GT(count, 200);
    EXPECT_LT(std::abs(sum / count), 0.01);
    EXPECT_LT(worst, 0.05);
}

}  // namespace
}  // namespace pm::test
