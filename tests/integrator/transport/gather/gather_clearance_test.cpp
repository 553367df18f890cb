// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// How near other surfaces are, where a camera sample asks for gather points.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>

#include "integrator/transport/gather/gather_points.h"
#include "tests/support/scene_maker.h"
#include "tests/support/statistics.h"

namespace pm::test {
namespace {

// Under a plate close over half of a floor. The camera, above it, sees points in the open beside
// it, few of whose rays go in; a place in the gap knows its height by looking straight up.
TEST(GatherPoints, PlacesInAGapKnowItsHeight) {
    constexpr std::int32_t kPixels = 64;
    constexpr double kGap = 0.01;
    SceneMaker maker;
    const auto white = maker.diffuse(Rgb(0.5f));
    maker.quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, white);
    maker.quad({-1, -1, kGap}, {1, 0, 0}, {0, 2, 0}, white);
    // A pixel of the floor is 1/64.
    maker.camera({0, 0, 5}, {0, 0, 0}, {0, 1, 0}, 2 * std::atan(0.1) * 180 / std::numbers::pi);
    const auto scene = maker.build();
    const Camera camera(*scene, kPixels, kPixels);
    const PhotonMap none(std::span<const Photon>{});
    const IrradianceSites sites(*scene, none, 0.01f);
    const GatherPoints points(*scene, camera, sites, {kPixels, kPixels, 2.5f, 4});
    const auto floor = static_cast<float>(-scene->centre().z);
    const float edge = static_cast<float>(-scene->centre().x);
    const auto clearanceAt = [&](Vec2f screen, float x) {
        const Ray ray = camera.ray({static_cast<double>(screen.x), static_cast<double>(screen.y)});
        const float along = (floor - ray.origin.z) / ray.direction.z;
        Vec3f position = ray.origin + ray.direction * along;
        position.x = edge + x;
        position.z = floor;
        const Vec3f up{0, 0, 1};
        GatherPoints::Estimate found;
        points.estimate({screen, position, up, up, 1e-6f}, found);
        return found.clearance;
    };
    float highest = 0.0f, lowestInTheOpen = std::numeric_limits<float>::max();
    int count = 0;
    Random random(1);
    for (int i = 0; i < 500; ++i) {
        // Half of a pixel to two pixels on both sides of the plate's edge.
        const float pixels = 0.5f + 1.5f * random.next();
        const float y = 8.0f + 48.0f * random.next();
        const auto at = [&](float side) {
            return clearanceAt({kPixels / 2 + side * pixels, y}, side * pixels / kPixels);
        };
        const float inside = at(-1.0f);
        if (std::isfinite(inside)) {  // there is a point near
            highest = std::max(highest, inside);
            ++count;
        }
        lowestInTheOpen = std::min(lowestInTheOpen, at(1.0f));
    }
    fmt::print("    at most {:.5f} at {} places in the gap, at least {:.5f} beside it\n", highest,
               count, lowestInTheOpen);
    EXPECT_GT(count, 300);
    EXPECT_NEAR(highest, static_cast<float>(kGap), 1e-5f);
    EXPECT_GT(lowestInTheOpen, static_cast<float>(kGap));
}

}  // namespace
}  // namespace pm::test
