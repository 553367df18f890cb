// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Refocused light, estimated where a camera sample has no gather point in reach.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <limits>
#include <span>
#include <vector>

#include "integrator/transport/gather/gather_points.h"
#include "tests/support/scene_maker.h"
#include "tests/support/statistics.h"

namespace pm::test {
namespace {

// Refocused light on a strip beside a wall, none beyond: straight above the strip there is nothing,
// and its estimate has to be as narrow as the wall is near. One as wide as in the open, the twin,
// finds less than half.
TEST(GatherPoints, RefocusedLightBesideAWall) {
    constexpr std::size_t kPhotons = 40'000;
    constexpr double kStrip = 0.2;
    SceneMaker maker;
    const auto white = maker.diffuse(Rgb(0.5f));
    maker.quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, white);
    maker.quad({-1, -1, 0}, {0, 2, 0}, {0, 0, 2}, white);
    maker.camera({0, 0, 3}, {0, 0, 0}, {0, 1, 0}, 40);
    const auto scene = maker.build();
    const Vec3d centre = scene->centre();
    const auto place = [&](double x, double y) { return Vec3f(Vec3d{x, y, 0} - centre); };
    const auto strip = [&](std::size_t count, std::uint64_t seed) {
        std::vector<Photon> photons;
        Random random(seed);
        for (std::size_t i = 0; i < count; ++i) {
            const Vec2f at = random.next2D();
            photons.push_back(
                {place(kStrip * static_cast<double>(at.x) - 1, 2 * static_cast<double>(at.y) - 1),
                 Rgb(1e-4f), PackedNormal(Vec3f{0, 0, 1})});
        }
        return photons;
    };
    const Camera camera(*scene, 16, 16);
    const PhotonMap none(std::span<const Photon>{});
    const IrradianceSites sites(*scene, none, 0.01f);
    // A sparse pilot: in the open estimates are wider than the strip.
    const PilotRadius radius(strip(200, 1), 400, 0.1f);
    const PhotonMap map(strip(kPhotons, 2));
    const SurfaceEstimate estimate(*scene, map, radius.typical());
    GatherPoints::Request request{16, 16, 2.5f, 1};
    request.refocused = &estimate;
    request.refocusedRadius = &radius;
    const GatherPoints points(*scene, camera, sites, request);
    const double irradiance = kPhotons * 1e-4 / (2 * kStrip);
    double known = 0, lookedFor = 0, open = 0;
    constexpr int kPlaces = 60;
    for (int i = 0; i < kPlaces; ++i) {
        const Vec3f at = place(-0.95, -0.6 + 0.02 * i), normal{0, 0, 1};
        const auto pattern = static_cast<std::uint32_t>(i);
        const GatherPoints::Place there{{}, at, normal, normal, 1e-6f};
        const auto share = [&](const TwoRadii& e) {
            return static_cast<double>(e.wide.r) / irradiance / kPlaces;
        };
        known += share(points.refocusedAt(there, 0.05f, pattern));
        lookedFor +=
            share(points.refocusedAt(there, std::numeric_limits<float>::infinity(), pattern));
        open += share(estimate.withRadius(radius.typical()).at(at, normal, pattern));
    }
    fmt::print("    beside a wall: {:.3f} and {:.3f} of what is there, as in the open {:.3f}\n",
               known, lookedFor, open);
    EXPECT_NEAR(known, 1, 0.05);
    EXPECT_NEAR(lookedFor, 1, 0.05);
    EXPECT_LT(open, 0.6);
}

}  // namespace
}  // namespace pm::test
