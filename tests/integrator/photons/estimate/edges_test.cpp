// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Irradiance estimates of sites where their disc is not whole: edges and corners (analytic F3), and
// thin walls, through which nothing may be counted (F8).
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "integrator/photons/estimate/irradiance_sites.h"
#include "integrator/photons/estimate/surface_patches.h"
#include "integrator/photons/trace/photon_tracer.h"
#include "tests/integrator/photons/estimate/even_light.h"
#include "tests/support/scene_maker.h"

namespace pm::test {
namespace {

constexpr float kRadius = 0.05f;

// How the area of a disc is found, as sites do it: by rays of each estimate, or by patches.
enum class By { kRays, kPatches };
const char* nameOf(By by) {
    return by == By::kRays ? "by rays" : "by patches";
}

// Mean over some turns of the pattern and points from `at` on along `step`.
Estimates estimate(const Scene& scene, const PhotonMap& map, By by, Vec3d at, Vec3d step,
                   int n = 16) {
    const SurfacePatches patches(scene, kRadius);
    const IrradianceSites sites(scene, map, kRadius, by == By::kPatches ? &patches : nullptr);
    Estimates mean;
    for (int i = 0; i < n; ++i) {
        const Vec3f position(at + step * i);
        const TwoRadii irradiance =
            sites.estimate(position, {0, 0, 1}, static_cast<std::uint32_t>(i));
        mean.corrected += static_cast<double>(irradiance.wide.r) / n;
        mean.narrow += static_cast<double>(irradiance.narrow.r) / n;
        mean.plain += static_cast<double>(map.fluxWithin(position, {0, 0, 1}, kRadius).wide.r /
                                          (kPi * kRadius * kRadius)) /
                      n;
    }
    return mean;
}

// A plate in the air, lit evenly.
TEST(Edges, OfAPlate) {
    SceneMaker maker;
    maker.quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, maker.diffuse(Rgb(0.5f)));
    const auto scene = maker.build();
    std::vector<Photon> photons;
    light(photons, {-1, -1, 0}, {2, 0, 0}, {0, 2, 0});
    const PhotonMap map(photons);
    for (const By by : {By::kRays, By::kPatches}) {
        SCOPED_TRACE(nameOf(by));
        const Estimates middle = estimate(*scene, map, by, {0, 0, 0}, {0.01, 0.013, 0});
        const Estimates edge = estimate(*scene, map, by, {-0.5, -0.9999, 0}, {0.05, 0, 0});
        const Estimates corner = estimate(*scene, map, by, {-0.9999, -0.9999, 0}, {0, 0, 0});
        report("middle", middle);
        report("edge", edge);
        report("corner", corner);
        EXPECT_NEAR(middle.corrected, 1, 0.02);
        EXPECT_NEAR(middle.narrow, 1, 0.02);
        EXPECT_NEAR(edge.corrected, 1, 0.05);
        EXPECT_NEAR(edge.narrow, 1, 0.05);
        EXPECT_NEAR(edge.plain, 0.5, 0.03);
        EXPECT_NEAR(corner.corrected, 1, 0.05);
        EXPECT_NEAR(corner.narrow, 1, 0.05);
        EXPECT_NEAR(corner.plain, 0.25, 0.03);
    }
}

// Strips that are next to nothing of a disc.
TEST(Edges, OfAWire) {
    for (const double width : {0.01, 0.003, 0.001}) {
        SceneMaker maker;
        maker.quad({-1, 0, 0}, {2, 0, 0}, {0, width, 0}, maker.diffuse(Rgb(0.5f)));
        const auto scene = maker.build();
        std::vector<Photon> photons;
        light(photons, {-1, 0, 0}, {2, 0, 0}, {0, width, 0});
        const PhotonMap map(photons);
        for (const By by : {By::kRays, By::kPatches}) {
            SCOPED_TRACE(nameOf(by));
            // Few of a point's rays meet a wire: estimates are noisy there, and the mean of 1 / n
            // is above that of n, most for the narrow radius with its fewer rays.
            const Estimates mean =
                estimate(*scene, map, by, {-0.5, 0, 0}, {1.0 / 1000, width / 1000, 0}, 1000);
            report(fmt::format("{:.2f} radii wide", width / 0.05).c_str(), mean);
            EXPECT_NEAR(mean.corrected, 1, 0.05);
            EXPECT_NEAR(mean.narrow, 1, 0.2);
            EXPECT_LT(mean.plain, 0.15);
        }
    }
}

// Where walls meet: their photons belong to them.
TEST(Edges, OfARoom) {
    SceneMaker maker;
    maker.box({-1, -1, -1}, {1, 1, 1}, maker.diffuse(Rgb(0.5f)), true);
    const auto scene = maker.build();
    std::vector<Photon> photons;
    light(photons, {-1, -1, -1}, {2, 0, 0}, {0, 2, 0});
    light(photons, {-1, -1, -1}, {0, 2, 0}, {0, 0, 2});
    light(photons, {-1, -1, -1}, {0, 0, 2}, {2, 0, 0});
    const PhotonMap map(photons);
    for (const By by : {By::kRays, By::kPatches}) {
        SCOPED_TRACE(nameOf(by));
        const Estimates edge = estimate(*scene, map, by, {-0.9999, -0.5, -1}, {0, 0.05, 0});
        const Estimates corner = estimate(*scene, map, by, {-0.9999, -0.9999, -1}, {0, 0, 0});
        const Estimates near = estimate(*scene, map, by, {-0.98, -0.5, -1}, {0, 0.05, 0});
        report("wall", edge);
        report("wall, .4 radii away", near);
        report("corner of three walls", corner);
        EXPECT_NEAR(edge.corrected, 1, 0.05);
        EXPECT_NEAR(edge.narrow, 1, 0.05);
        EXPECT_NEAR(edge.plain, 0.5, 0.03);
        EXPECT_NEAR(near.corrected, 1, 0.05);
        EXPECT_NEAR(near.narrow, 1, 0.05);
        EXPECT_LT(near.plain, 0.8);
        EXPECT_NEAR(corner.corrected, 1, 0.05);
        EXPECT_NEAR(corner.narrow, 1, 0.05);
        EXPECT_NEAR(corner.plain, 0.25, 0.03);
    }
}

// A thin wall on a floor that is lit on one side only: nothing comes through beneath it, nor over
// it though it be lower than the radius.
TEST(Edges, NoLightThroughAThinWall) {
    for (const double height : {1.0, 0.6 * static_cast<double>(kRadius)}) {
        SceneMaker maker;
        const auto grey = maker.diffuse(Rgb(0.5f));
        maker.quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, grey);
        maker.quad({0, -1, 0}, {0, 2, 0}, {0, 0, height}, grey);
        const auto scene = maker.build();
        const Vec3d origin = -scene->centre();
        std::vector<Photon> photons;
        light(photons, origin + Vec3d(0, -1, 0), {1, 0, 0}, {0, 2, 0});
        const PhotonMap map(photons);
        for (const By by : {By::kRays, By::kPatches}) {
            SCOPED_TRACE(fmt::format("{}, height {}", nameOf(by), height));
            const Vec3d step{0, 0.05, 0};
            const Estimates dark = estimate(*scene, map, by, origin + Vec3d(-0.02, -0.5, 0), step);
            const Estimates lit = estimate(*scene, map, by, origin + Vec3d(0.02, -0.5, 0), step);
            report("dark side", dark);
            report("lit side", lit);
            EXPECT_EQ(dark.corrected, 0.0);
            EXPECT_EQ(dark.narrow, 0.0);
            EXPECT_GT(dark.plain, 0.1);
            EXPECT_NEAR(lit.corrected, 1, 0.05);
            EXPECT_NEAR(lit.narrow, 1, 0.05);
        }
    }
}

// The far side of the wall itself, with photons as they are traced (P1, F8).
TEST(Edges, TheFarSideOfAWallIsDark) {
    SceneMaker maker;
    maker.quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, maker.diffuse(Rgb(0.5f)));
    maker.sphere({0, 0, 2}, 0.5, maker.diffuse({}, Rgb(1.0f)));
    const auto scene = maker.build();
    const LightSampler lights(*scene);
    const PhotonMap map(tracePhotons(*scene, lights, {PhotonKind::kGlobal, 200'000, 1, 0},
                                     std::atomic<bool>{false}, {})
                            .photons);
    ASSERT_GT(map.size(), 10'000u);
    const IrradianceSites sites(*scene, map, kRadius);
    for (const double x : {-0.999, -0.5, 0.0, 0.3}) {
        const Vec3f p(Vec3d{x, 0.1, 0} - scene->centre());
        EXPECT_EQ(sites.estimate(p, {0, 0, -1}, 1).wide, Rgb());
        EXPECT_EQ(sites.at(p, {0, 0, -1}).wide, Rgb());
        // pi L (R/d)^2 cos^2 with the distance from the lamp's centre.
        const double d2 = x * x + 0.01 + 4;
        const double expected = std::numbers::pi * 0.25 / d2 * 2 / std::sqrt(d2);
        EXPECT_NEAR(static_cast<double>(sites.estimate(p, {0, 0, 1}, 1).wide.r), expected,
                    0.2 * expected);
    }
}

}  // namespace
}  // namespace pm::test
