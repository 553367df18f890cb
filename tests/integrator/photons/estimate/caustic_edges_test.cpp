// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Caustics' estimates, at radii of their own, where their disc is not whole (analytic F3, F8).
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "integrator/photons/estimate/caustic_map.h"
#include "integrator/sampling/warps.h"
#include "tests/integrator/photons/estimate/even_light.h"
#include "tests/support/scene_maker.h"

namespace pm::test {
namespace {

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

// What is lit many times has fewer photons: a disc has as many, and is larger.
constexpr int kCells = 350;

// Two corners have too few photons for one lighting to show an error of 5 %, and few rays stand for
// the surface where no patch does: estimate(seed, away) is asked for many, and at other places.
template <typename Estimate>
void expectEvenOverLights(const char* where, const Estimate& estimate) {
    constexpr std::uint32_t kLights = 8;
    std::vector<Estimates> of;
    for (std::uint64_t seed = 1; seed <= kLights; ++seed)
        of.push_back(estimate(seed, 1e-4 * static_cast<double>(seed)));
    const Moments corrected = momentsOf(kLights, [&](auto i) { return of[i].corrected; });
    const Moments narrow = momentsOf(kLights, [&](auto i) { return of[i].narrow; });
    const Moments plain = momentsOf(kLights, [&](auto i) { return of[i].plain; });
    report(where, {corrected.mean, narrow.mean, plain.mean, 0});
    fmt::print("        standard errors {:.3f}, {:.3f}, {:.3f}\n", corrected.standardError,
               narrow.standardError, plain.standardError);
    EXPECT_NEAR(corrected.mean, 1, 0.05) << where;
    EXPECT_NEAR(narrow.mean, 1, 0.05) << where;
    EXPECT_LT(narrow.standardError, 0.02) << where;
    EXPECT_NEAR(plain.mean, 0.25, 0.03) << where;
}

TEST(CausticEdges, OfAPlate) {
    SceneMaker maker;
    maker.quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, maker.diffuse(Rgb(0.5f)));
    const auto scene = maker.build();
    const auto lit = [&](std::uint64_t seed) {
        std::vector<Photon> photons;
        light(photons, {-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, seed, kCells);
        return CausticEdges(scene, photons);
    };
    const CausticEdges caustic = lit(1);
    const Estimates edge = caustic.estimate({-0.5, -0.9999, 0}, {0.015, 0, 0}, 64);
    expectEven("middle", caustic.estimate({-0.5, -0.5, 0}, {0.01, 0.013, 0}, 64));
    expectEven("edge", edge);
    expectEven("less than a radius away", caustic.estimate({-0.5, -0.98, 0}, {0.015, 0, 0}, 64));
    EXPECT_NEAR(edge.plain, 0.5, 0.03);
    // From one corner to the opposite one.
    expectEvenOverLights("corner", [&](std::uint64_t seed, double away) {
        const double side = 1 - away;
        return lit(seed).estimate({-side, -side, 0}, {2 * side, 2 * side, 0}, 2);
    });
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
    const auto scene = maker.build();
    const auto lit = [&](std::uint64_t seed) {
        std::vector<Photon> photons;
        light(photons, {-1, -1, -1}, {2, 0, 0}, {0, 2, 0}, seed, kCells);
        light(photons, {-1, -1, -1}, {0, 2, 0}, {0, 0, 2}, seed, kCells);
        light(photons, {-1, -1, -1}, {0, 0, 2}, {2, 0, 0}, seed, kCells);
        return CausticEdges(scene, photons);
    };
    const CausticEdges caustic = lit(1);
    expectEven("wall", caustic.estimate({-0.9999, -0.5, -1}, {0, 0.015, 0}, 64));
    expectEven("away from it", caustic.estimate({-0.98, -0.5, -1}, {0, 0.015, 0}, 64));
    expectEvenOverLights("corner of three walls", [&](std::uint64_t seed, double away) {
        const double side = 1 - away;
        return lit(seed).estimate({-side, -side, -1}, {2 * side, 2 * side, 0}, 2);
    });
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
