// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Irradiance estimates where their disc is not whole: edges and corners (analytic F3), and thin
// walls, through which nothing may be counted (F8).
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "integrator/photons/caustic_map.h"
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
    double worst = 0;  // a corrected one's distance from 1
};

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

void report(const char* where, const Estimates& e) {
    fmt::print("    {}: {:.3f} of E, at the narrow radius {:.3f}, uncorrected {:.3f}", where,
               e.corrected, e.narrow, e.plain);
    if (e.worst > 0) fmt::print(", worst {:.3f} off", e.worst);
    fmt::print("\n");
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

std::vector<Photon> everyFourth(const std::vector<Photon>& photons) {
    std::vector<Photon> pilot;
    for (std::size_t i = 0; i < photons.size(); i += PilotRadius::kPilotShare)
        pilot.push_back(photons[i]);
    return pilot;
}

// An even caustic, estimated by the caustic map at radii of its own.
class CausticEdges {
  public:
    // factor: of the radii.
    CausticEdges(std::shared_ptr<const Scene> scene, const std::vector<Photon>& photons,
                 float factor = 1)
        : m_scene(std::move(scene)),
          m_radius(everyFourth(photons), 500, 0.1f),
          m_patches(*m_scene, m_radius.typical()),
          m_corrected(photons, m_radius, factor, &m_patches),
          m_plain(photons, m_radius, factor, nullptr) {}

    // Mean over n points from `at` on along `step`, on the side of the normal.
    Estimates estimate(Vec3d at, Vec3d step, int n, Vec3f normal = {0, 0, 1}) const {
        Estimates mean;
        NearestPhotons scratch;
        for (int i = 0; i < n; ++i) {
            const Vec3f position(at + step * i);
            const TwoRadii e = m_corrected.irradiance(position, normal, scratch);
            mean.corrected += static_cast<double>(e.wide.r) / n;
            mean.narrow += static_cast<double>(e.narrow.r) / n;
            mean.worst = std::max(mean.worst, std::abs(static_cast<double>(e.wide.r) - 1));
            mean.plain +=
                static_cast<double>(m_plain.irradiance(position, normal, scratch).wide.r) / n;
        }
        return mean;
    }
    float typical() const { return m_radius.typical(); }

  private:
    std::shared_ptr<const Scene> m_scene;
    PilotRadius m_radius;
    SurfacePatches m_patches;
    CausticMap m_corrected, m_plain;
};

// Everywhere, not only in the mean: the worst point, too, is within 10 %.
void expectEven(const char* where, const Estimates& e) {
    report(where, e);
    EXPECT_NEAR(e.corrected, 1, 0.05) << where;
    EXPECT_NEAR(e.narrow, 1, 0.05) << where;
    EXPECT_LT(e.worst, 0.1) << where;
}

TEST(CausticEdges, OfAPlate) {
    SceneMaker maker;
    maker.quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, maker.diffuse(Rgb(0.5f)));
    std::vector<Photon> photons;
    light(photons, {-1, -1, 0}, {2, 0, 0}, {0, 2, 0});
    const CausticEdges caustic(maker.build(), photons);
    const Estimates edge = caustic.estimate({-0.5, -0.9999, 0}, {0.015, 0, 0}, 64);
    // From one corner to the opposite one.
    const Estimates corner = caustic.estimate({-0.9999, -0.9999, 0}, {1.9998, 1.9998, 0}, 2);
    expectEven("middle", caustic.estimate({-0.5, -0.5, 0}, {0.01, 0.013, 0}, 64));
    expectEven("edge", edge);
    expectEven("less than a radius away", caustic.estimate({-0.5, -0.98, 0}, {0.015, 0, 0}, 64));
    expectEven("corner", corner);
    EXPECT_NEAR(edge.plain, 0.5, 0.03);
    EXPECT_NEAR(corner.plain, 0.25, 0.03);
}

// At an angle to all axes, and so to cells and grids.
TEST(CausticEdges, OfATurnedPlate) {
    const Vec3d a = normalize(Vec3d{2, 1, 0.7});
    const Vec3d b = normalize(cross(a, Vec3d{0.3, 1, -2})), n = cross(a, b);
    SceneMaker maker;
    maker.quad(-a - b, a * 2, b * 2, maker.diffuse(Rgb(0.5f)));
    const auto scene = maker.build();
    const Vec3d middle = -scene->centre();
    std::vector<Photon> photons;
    light(photons, middle - a - b, a * 2, b * 2);
    const CausticEdges caustic(scene, photons);
    const Vec3f normal(n);
    expectEven("turned, middle", caustic.estimate(middle - a * 0.5, a * 0.015, 64, normal));
    expectEven("turned, edge",
               caustic.estimate(middle - a * 0.5 - b * 0.9999, a * 0.015, 64, normal));
    expectEven("turned, corner",
               caustic.estimate(middle - (a + b) * 0.9999, (a + b) * 1.9998, 2, normal));
}

TEST(CausticEdges, OfARoom) {
    SceneMaker maker;
    maker.box({-1, -1, -1}, {1, 1, 1}, maker.diffuse(Rgb(0.5f)), true);
    std::vector<Photon> photons;
    light(photons, {-1, -1, -1}, {2, 0, 0}, {0, 2, 0});
    light(photons, {-1, -1, -1}, {0, 2, 0}, {0, 0, 2});
    light(photons, {-1, -1, -1}, {0, 0, 2}, {2, 0, 0});
    const CausticEdges caustic(maker.build(), photons);
    expectEven("wall", caustic.estimate({-0.9999, -0.5, -1}, {0, 0.015, 0}, 64));
    expectEven("away from it", caustic.estimate({-0.98, -0.5, -1}, {0, 0.015, 0}, 64));
    expectEven("corner of three walls",
               caustic.estimate({-0.9999, -0.9999, -1}, {1.9998, 1.9998, 0}, 2));
}

// Half of the discs is in the dark beyond the wall, and half of the dark side's in the light.
TEST(CausticEdges, NoLightThroughAThinWall) {
    SceneMaker maker;
    const auto grey = maker.diffuse(Rgb(0.5f));
    maker.quad({-1, -1, -0.5}, {2, 0, 0}, {0, 2, 0}, grey);
    maker.quad({0, -1, -0.5}, {0, 2, 0}, {0, 0, 1}, grey);
    std::vector<Photon> photons;
    light(photons, {0, -1, -0.5}, {1, 0, 0}, {0, 2, 0});
    const CausticEdges caustic(maker.build(), photons);
    for (const double away : {0.003, 0.01, 0.02}) {
        const Estimates dark = caustic.estimate({-away, -0.5, -0.5}, {0, 0.015, 0}, 64);
        report("dark side", dark);
        EXPECT_EQ(dark.corrected, 0.0);
        EXPECT_EQ(dark.narrow, 0.0);
        EXPECT_GT(dark.plain, 0.1);
        const Estimates lit = caustic.estimate({away, -0.5, -0.5}, {0, 0.015, 0}, 64);
        report("lit side", lit);
        EXPECT_NEAR(lit.corrected, 1, 0.05);
        EXPECT_NEAR(lit.narrow, 1, 0.05);
    }
}

// The focus of a ball of glass that stands on the floor lies right under it.
TEST(CausticEdges, UnderABall) {
    SceneMaker maker;
    maker.quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, maker.diffuse(Rgb(0.5f)));
    MaterialDescription glass;
    glass.kind = MaterialKind::kDielectric;
    maker.sphere({0, 0, 0.1}, 0.1, maker.material(glass));
    const auto scene = maker.build();
    const Vec3d origin = -scene->centre();
    std::vector<Photon> photons;
    light(photons, origin + Vec3d{-1, -1, 0}, {2, 0, 0}, {0, 2, 0});
    const CausticEdges caustic(scene, photons);
    expectEven("under the ball", caustic.estimate(origin, {0.0016, 0.0003, 0}, 64));
}

// A ball smaller than the disc in the middle of it, whose area bends away.
TEST(CausticEdges, OfASmallBall) {
    constexpr double kBall = 0.1;
    SceneMaker maker;
    maker.quad({-1, -1, -1}, {2, 0, 0}, {0, 2, 0}, maker.diffuse(Rgb(0.5f)));
    maker.sphere({0, 0, 0}, kBall, maker.diffuse(Rgb(0.5f)));
    const auto scene = maker.build();
    const Vec3d centre = -scene->centre();
    std::vector<Photon> photons;
    Random random(5);
    constexpr int kCount = 100'000;
    for (int i = 0; i < kCount; ++i) {
        const Vec3f n = sampleUniformSphere(random.next2D());
        photons.push_back({Vec3f(centre + Vec3d(n) * kBall),
                           Rgb(static_cast<float>(4 * std::numbers::pi * kBall * kBall / kCount)),
                           PackedNormal(n)});
    }
    for (const float factor : {1.0f, 2.0f, 3.0f, 4.0f}) {
        const CausticEdges caustic(scene, photons, factor);
        double mean = 0, plain = 0;
        for (int i = 0; i < 200; ++i) {
            const Vec3f n = sampleUniformSphere(random.next2D());
            const Estimates e = caustic.estimate(centre + Vec3d(n) * kBall, {}, 1, n);
            mean += e.corrected / 200;
            plain += e.plain / 200;
        }
        fmt::print("    radius {:.2f} of the ball's: {:.3f} of E, uncorrected {:.3f}\n",
                   static_cast<double>(factor * caustic.typical()) / kBall, mean, plain);
        EXPECT_NEAR(mean, 1, 0.05);
    }
}

// Whoever asks first, with or without room to keep what was found.
TEST(CausticEdges, TheSameBitsInAnyOrder) {
    SceneMaker maker;
    const auto grey = maker.diffuse(Rgb(0.5f));
    maker.box({-1, -1, -1}, {1, 1, 1}, grey, true);
    maker.sphere({0, 0, -0.9}, 0.1, grey);
    const auto scene = maker.build();
    std::vector<Photon> photons;
    light(photons, {-1, -1, -1}, {2, 0, 0}, {0, 2, 0});
    const PilotRadius radius(everyFourth(photons), 500, 0.1f);
    std::vector<Vec3f> points;
    Random random(7);
    for (int i = 0; i < 2000; ++i) {
        const Vec2f u = random.next2D();
        points.push_back({2 * u.x - 1, 2 * u.y - 1, -1});
    }
    const auto estimates = [&](std::uint64_t room, bool backwards) {
        const SurfacePatches patches(*scene, radius.typical(), room);
        const CausticMap map(photons, radius, 1, &patches);
        std::vector<std::array<float, 2>> found(points.size());
        tbb::parallel_for(std::size_t{0}, points.size(), [&](std::size_t i) {
            const std::size_t at = backwards ? points.size() - 1 - i : i;
            NearestPhotons scratch;
            const TwoRadii e = map.irradiance(points[at], {0, 0, 1}, scratch);
            found[at] = {e.wide.r, e.narrow.r};
        });
        EXPECT_LE(patches.memoryBytes(), room);
        return found;
    };
    const auto first = estimates(SurfacePatches::kMostBytes, false);
    EXPECT_EQ(first, estimates(SurfacePatches::kMostBytes, true));
    EXPECT_EQ(first, estimates(0, false));
}

}  // namespace
}  // namespace pm::test
