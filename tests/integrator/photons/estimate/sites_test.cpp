// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Irradiance kept at sites against irradiance estimated at the point itself.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>

#include "integrator/photons/estimate/irradiance_sites.h"
#include "integrator/photons/estimate/surface_patches.h"
#include "integrator/photons/map/photon_pages.h"
#include "integrator/photons/trace/photon_tracer.h"
#include "integrator/sampling/warps.h"
#include "tests/support/memory_scratch.h"
#include "tests/support/scene_maker.h"
#include "tests/support/statistics.h"

namespace pm::test {
namespace {

// One photon in each cell of a grid on a square of side 2 in the plane of height z, of irradiance
// `level` + `slope` x.
void light(std::vector<Photon>& photons, double z, double level, double slope) {
    constexpr int kCells = 400;
    Random random(1);
    for (int j = 0; j < kCells; ++j)
        for (int i = 0; i < kCells; ++i) {
            const Vec2f u = random.next2D();
            const double x = -1 + 2 * (i + static_cast<double>(u.x)) / kCells;
            const double y = -1 + 2 * (j + static_cast<double>(u.y)) / kCells;
            const auto flux = static_cast<float>((level + slope * x) * 4 / (kCells * kCells));
            photons.push_back({Vec3f(Vec3d{x, y, z}), Rgb(flux), PackedNormal({0, 0, 1})});
        }
}

std::vector<Vec3f> pointsOnPlane(int count, float z) {
    Random random(2);
    std::vector<Vec3f> points;
    for (int i = 0; i < count; ++i) {
        const Vec2f u = random.next2D();
        points.push_back({1.4f * u.x - 0.7f, 1.4f * u.y - 0.7f, z});
    }
    return points;
}

constexpr Vec3f kUp{0, 0, 1};

TEST(Sites, FollowASlope) {
    SceneMaker maker;
    maker.quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, maker.diffuse(Rgb(0.5f)));
    const auto scene = maker.build();
    std::vector<Photon> photons;
    light(photons, 0, 2, 1);
    const PhotonMap map(photons);
    const IrradianceSites sites(*scene, map, 0.05f);
    double error = 0, worst = 0, narrow = 0;
    const auto points = pointsOnPlane(2000, 0);
    for (const Vec3f& p : points) {
        const double expected = 2 + static_cast<double>(p.x);
        const TwoRadii found = sites.at(p, kUp);
        error += (static_cast<double>(found.wide.r) - expected) / expected;
        narrow += (static_cast<double>(found.narrow.r) - expected) / expected;
        worst = std::max(worst, std::abs(static_cast<double>(found.wide.r) - expected));
    }
    const auto n = static_cast<double>(points.size());
    fmt::print("    mean error {:.4f}, narrow {:.4f}, worst {:.3f}\n", error / n, narrow / n,
               worst);
    EXPECT_NEAR(error / n, 0, 0.003);
    EXPECT_NEAR(narrow / n, 0, 0.003);
    // No site is farther away than a cell's diagonal, 0.042; the rest is noise.
    EXPECT_LT(worst, 0.15);
}

// Of a map in pages of which an eighth is held: filled in the map's order, pages are read a few
// times; asked for in no order, again and again.
TEST(Sites, FilledOnesAreThoseAskedFor) {
    SceneMaker maker;
    maker.quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, maker.diffuse(Rgb(0.5f)));
    const auto scene = maker.build();
    std::vector<Photon> photons;
    light(photons, 0, 2, 1);
    MemoryScratch folder;
    PhotonPaging paging(folder, photons.size() * 28 / 8);
    auto spool = std::make_unique<PhotonSpool>(paging.makeFile());
    spool->append(photons);
    spool->finish();
    const PhotonMap map(std::move(spool), paging);
    const IrradianceSites asked(*scene, map, 0.05f), filled(*scene, map, 0.05f);
    const std::uint64_t pages = photons.size() / 1024 + 1;
    const auto missesOf = [&](auto act) {
        const std::uint64_t before = paging.counts().misses;
        act();
        return paging.counts().misses - before;
    };
    tbb::task_arena(1).execute([&] { EXPECT_LT(missesOf([&] { filled.fill({}); }), 4 * pages); });
    EXPECT_GT(paging.counts().missesOf[static_cast<std::size_t>(CacheUser::kPhoton)], pages / 2);
    std::vector<TwoRadii> found, wanted;
    const auto points = pointsOnPlane(2000, 0);
    EXPECT_LT(missesOf([&] {
                  for (const Vec3f& p : points) found.push_back(filled.at(p, kUp));
              }),
              pages / 4);
    EXPECT_GT(missesOf([&] {
                  for (const Vec3f& p : points) wanted.push_back(asked.at(p, kUp));
              }),
              8 * pages);
    for (std::size_t i = 0; i < points.size(); ++i) {
        EXPECT_EQ(found[i].wide, wanted[i].wide) << i;
        EXPECT_EQ(found[i].narrow, wanted[i].narrow) << i;
    }
}

// Two plates a fifth of a cell apart, each with its light: no site speaks for the other plate.
TEST(Sites, TellPlatesApart) {
    SceneMaker maker;
    const auto grey = maker.diffuse(Rgb(0.5f));
    maker.quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, grey);
    maker.quad({-1, -1, 0.02}, {2, 0, 0}, {0, 2, 0}, grey);
    const auto scene = maker.build();
    std::vector<Photon> photons;
    light(photons, -0.01, 1, 0);
    light(photons, 0.01, 4, 0);
    const PhotonMap map(photons);
    const IrradianceSites sites(*scene, map, 0.2f);
    int far = 0;
    for (const auto& [z, expected] : {std::pair{-0.01f, 1.0f}, std::pair{0.01f, 4.0f}})
        for (const Vec3f& p : pointsOnPlane(300, z)) {
            const TwoRadii kept = sites.at(p, kUp), own = sites.estimate(p, kUp, 1);
            far += std::abs(kept.wide.r - own.wide.r) > 0.2f * expected;
        }
    EXPECT_EQ(far, 0);
}

struct Room {
    Room() {
        SceneMaker maker;
        const auto grey = maker.diffuse(Rgb(0.5f));
        maker.box({-1, -1, -1}, {1, 1, 1}, grey, true);
        maker.box({-0.4, -0.3, -1}, {0.2, 0.3, -0.2}, grey, false);
        maker.sphere({0.6, 0.2, -0.7}, 0.3, grey);
        maker.sphere({0, 0, 0.7}, 0.1, maker.diffuse({}, Rgb(1.0f)));
        scene = maker.build();
        const LightSampler lights(*scene);
        photons = tracePhotons(*scene, lights, {PhotonKind::kGlobal, 50'000, 1, 0},
                               std::atomic<bool>{false}, {})
                      .photons;
    }
    struct Point {
        Vec3f position, normal;
    };
    std::vector<Point> points(int count) const {
        Random random(3);
        std::vector<Point> found;
        while (static_cast<int>(found.size()) < count) {
            const Vec3f direction = sampleUniformSphere(random.next2D());
            Surface s;
            if (!scene->intersect({Vec3f(0.7f, -0.6f, 0.5f), direction}, s)) continue;
            const bool front = dot(s.geometricNormal, direction) < 0.0f;
            found.push_back({s.position, front ? s.geometricNormal : -s.geometricNormal});
        }
        return found;
    }
    std::shared_ptr<const Scene> scene;
    BigVector<Photon> photons;
};

// What is read never depends on who asked before.
TEST(Sites, TheSameBitsInAnyOrder) {
    const Room room;
    const PhotonMap map(room.photons);
    const auto points = room.points(20'000);
    // With tables of their own, and with room for a few patches only.
    const SurfacePatches one(*room.scene, 0.1f), two(*room.scene, 0.1f),
        three(*room.scene, 0.1f, 10'000);
    const IrradianceSites forward(*room.scene, map, 0.1f, &one),
        backward(*room.scene, map, 0.1f, &two), parallel(*room.scene, map, 0.1f, &three);
    std::vector<TwoRadii> expected(points.size()), found(points.size());
    for (std::size_t i = 0; i < points.size(); ++i)
        expected[i] = forward.at(points[i].position, points[i].normal);
    for (std::size_t i = points.size(); i-- > 0;)
        found[i] = backward.at(points[i].position, points[i].normal);
    const auto expectSame = [&] {
        for (std::size_t i = 0; i < points.size(); ++i) {
            ASSERT_EQ(found[i].wide, expected[i].wide);
            ASSERT_EQ(found[i].narrow, expected[i].narrow);
        }
    };
    expectSame();
    tbb::parallel_for(std::size_t{0}, points.size(), [&](std::size_t i) {
        found[i] = parallel.at(points[i].position, points[i].normal);
    });
    expectSame();
}

// Neither sites nor patches bring light or darkness on the whole: flat and bent surfaces, edges and
// contacts.
TEST(Sites, KeepTheMean) {
    const Room room;
    const PhotonMap map(room.photons);
    const SurfacePatches patches(*room.scene, 0.1f);
    double kept = 0, own = 0, difference = 0;
    std::uint32_t pattern = 0;
    for (const float radius : {0.06f, 0.1f, 0.15f}) {
        const IrradianceSites sites(*room.scene, map, radius, &patches);
        const SurfaceEstimate byRays(*room.scene, map, radius);
        for (const Room::Point& p : room.points(4000)) {
            const auto a = static_cast<double>(sites.at(p.position, p.normal).wide.r);
            const auto b = static_cast<double>(byRays.at(p.position, p.normal, ++pattern).wide.r);
            kept += a;
            own += b;
            difference += (a - b) * (a - b);
        }
    }
    const double error = std::sqrt(difference);  // of the sum, were the points independent
    fmt::print("    {:.4f} of the estimates' mean, +- {:.4f}\n", kept / own, error / own);
    EXPECT_NEAR(kept / own, 1, 0.01);
}

// A ball bends away from every estimate's plane; its area must be found all the same.
TEST(Sites, BentSurfacesAreWhole) {
    SceneMaker maker;
    maker.sphere({0, 0, 0}, 1.0, maker.diffuse(Rgb(0.5f)));
    maker.pointLight({0, 0, 0}, Rgb(1.0f));
    const auto scene = maker.build();
    const LightSampler lights(*scene);
    const PhotonMap map(tracePhotons(*scene, lights, {PhotonKind::kGlobal, 100'000, 1, 0},
                                     std::atomic<bool>{false}, {})
                            .photons);
    for (const float radius : {0.022f, 0.07f, 0.2f}) {
        const IrradianceSites sites(*scene, map, radius);
        Random random(4);
        double wide = 0, narrow = 0;
        const int n = 4000;
        for (int i = 0; i < n; ++i) {
            const Vec3f p = sampleUniformSphere(random.next2D());
            const TwoRadii e = sites.estimate(p, -p, static_cast<std::uint32_t>(i));
            wide += static_cast<double>(e.wide.r) / (2 * n);
            narrow += static_cast<double>(e.narrow.r) / (2 * n);
        }
        fmt::print("    radius {}: {:.4f} of E, narrow {:.4f}\n", radius, wide, narrow);
        EXPECT_NEAR(wide, 1, 0.025) << radius;
        EXPECT_NEAR(narrow, 1, 0.025) << radius;
    }
}

// Where there are no photons there is no light, and no ray is needed to say so.
TEST(Sites, DarkWithoutPhotons) {
    const Room room;
    const PhotonMap map(std::vector<Photon>{});
    const IrradianceSites sites(*room.scene, map, 0.1f);
    for (const Room::Point& p : room.points(100))
        EXPECT_EQ(sites.at(p.position, p.normal).wide, Rgb());
}

}  // namespace
}  // namespace pm::test
