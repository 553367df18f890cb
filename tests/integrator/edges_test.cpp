// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Irradiance estimates where their disc is not whole: edges and corners (analytic F3), and thin
// walls, through which nothing may be counted (F8).
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "integrator/photons/irradiance_sites.h"
#include "integrator/photons/photon_tracer.h"
#include "integrator/sampling/warps.h"
#include "tests/integrator/scene_maker.h"
#include "tests/integrator/statistics.h"

namespace pm::test {
namespace {

constexpr float kRadius = 0.05f;

// Photons that make an irradiance of 1 on a parallelogram, one in each cell of a grid.
void light(std::vector<Photon>& photons, Vec3d p, Vec3d e0, Vec3d e1) {
    constexpr int kCells = 500;
    Random random(1);
    const Vec3d n = cross(e0, e1);
    const auto flux = static_cast<float>(length(n) / (kCells * kCells));
    for (int j = 0; j < kCells; ++j)
        for (int i = 0; i < kCells; ++i) {
            const Vec2f u = random.next2D();
            photons.push_back({Vec3f(p + e0 * ((i + static_cast<double>(u.x)) / kCells) +
                                     e1 * ((j + static_cast<double>(u.y)) / kCells)),
                               Rgb(flux), PackedNormal(Vec3f(normalize(n)))});
        }
}

struct Estimates {
    double corrected = 0, narrow = 0, plain = 0;
};

// Mean over some turns of the pattern and points from `at` on along `step`.
Estimates estimate(const Scene& scene, const PhotonMap& map, Vec3d at, Vec3d step) {
    const IrradianceSites sites(scene, map, kRadius);
    Estimates mean;
    const int n = 16;
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

void report(const char* where, const Estimates& e) {
    fmt::print("    {}: {:.3f} of E, at the narrow radius {:.3f}, uncorrected {:.3f}\n", where,
               e.corrected, e.narrow, e.plain);
}

// A plate in the air, lit evenly.
TEST(Edges, OfAPlate) {
    SceneMaker maker;
    maker.quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, maker.diffuse(Rgb(0.5f)));
    const auto scene = maker.build();
    std::vector<Photon> photons;
    light(photons, {-1, -1, 0}, {2, 0, 0}, {0, 2, 0});
    const PhotonMap map(photons);
    const Estimates middle = estimate(*scene, map, {0, 0, 0}, {0.01, 0.013, 0});
    const Estimates edge = estimate(*scene, map, {-0.5, -0.9999, 0}, {0.05, 0, 0});
    const Estimates corner = estimate(*scene, map, {-0.9999, -0.9999, 0}, {0, 0, 0});
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
    const Estimates edge = estimate(*scene, map, {-0.9999, -0.5, -1}, {0, 0.05, 0});
    const Estimates corner = estimate(*scene, map, {-0.9999, -0.9999, -1}, {0, 0, 0});
    const Estimates near = estimate(*scene, map, {-0.98, -0.5, -1}, {0, 0.05, 0});
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

// A thin wall on a floor that is lit on one side only: nothing comes through beneath it.
TEST(Edges, NoLightThroughAThinWall) {
    SceneMaker maker;
    const auto grey = maker.diffuse(Rgb(0.5f));
    maker.quad({-1, -1, -0.5}, {2, 0, 0}, {0, 2, 0}, grey);
    maker.quad({0, -1, -0.5}, {0, 2, 0}, {0, 0, 1}, grey);
    const auto scene = maker.build();
    std::vector<Photon> photons;
    light(photons, {0, -1, -0.5}, {1, 0, 0}, {0, 2, 0});
    const PhotonMap map(photons);
    const Estimates dark = estimate(*scene, map, {-0.02, -0.5, -0.5}, {0, 0.05, 0});
    const Estimates lit = estimate(*scene, map, {0.02, -0.5, -0.5}, {0, 0.05, 0});
    report("dark side", dark);
    report("lit side", lit);
    EXPECT_EQ(dark.corrected, 0.0);
    EXPECT_EQ(dark.narrow, 0.0);
    EXPECT_GT(dark.plain, 0.1);
    EXPECT_NEAR(lit.corrected, 1, 0.05);
    EXPECT_NEAR(lit.narrow, 1, 0.05);
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
