// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Gather points bring what each camera sample's own gather ray would bring; what they bring depends
// on the place alone.
#include "integrator/transport/gather/gather_points.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>
#include <vector>

#include "tests/support/replicates.h"
#include "tests/support/rooms.h"
#include "tests/support/statistics.h"

namespace pm::test {
namespace {

constexpr std::int32_t kSize = 48, kRegion = 8;
constexpr float kNothingNear = std::numeric_limits<float>::infinity();

// Where all surfaces emit and reflect alike, irradiance is the same everywhere, whatever is
// averaged: in corners, in gaps and on bent surfaces.
TEST(GatherPoints, FurnaceIsConstant) {
    SceneMaker maker;
    const auto warm = maker.diffuse(Rgb(0.5f), Rgb(0.5f));
    maker.box({-1, -1, -1}, {1, 1, 1}, warm, true);
    maker.sphere({0.4, -0.6, -0.3}, 0.4, warm);
    maker.box({-0.7, -0.97, -0.6}, {-0.1, -0.5, 0}, warm, false);
    maker.camera({0, 0, 0.9}, {0, -0.4, -1}, {0, 1, 0}, 70);
    const auto scene = maker.build();
    const std::vector<Rect> regions = squares(kSize, kSize, kRegion);
    const auto renders = replicate(12, [&](std::uint64_t seed) {
        RenderSettings settings = smallFrame(kSize, kSize, IntegratorKind::kPhoton, 2, 3);
        settings.photons = 50'000;
        settings.seed = seed;
        return render(scene, settings, regions);
    });
    // Direct light is half of what is reflected, indirect light the other half.
    for (std::size_t r = 0; r < regions.size(); ++r) {
        const Replicated indirect = spread(renders, r, kIndirect, 0);
        EXPECT_LT(zScore(indirect, {0.25, 0, 100}, 0.02 * 0.25), 4) << r << " " << indirect.mean;
    }
    const Replicated all = spread(wholeFrames(renders), 0, kIndirect, 0);
    fmt::print("    furnace: {:.4f} of what is expected +- {:.4f}\n", all.mean / 0.25,
               all.standardError / 0.25);
    EXPECT_LT(zScore(all, {0.25, 0, 100}, 0.005 * 0.25), 4);
}

// Photons of one half of the plane [-1, 1]^2, x from x0 on, all with the same flux.
void addHalf(std::vector<Photon>& photons, float x0, std::size_t count, std::uint64_t seed) {
    Random random(seed);
    for (std::size_t i = 0; i < count; ++i) {
        const Vec2f at = random.next2D();
        photons.push_back({{x0 + at.x, 2 * at.y - 1, 0}, Rgb(1e-4f), PackedNormal(Vec3f{0, 0, 1})});
    }
}

// Refocused light on a plane, 16 times as bright on its left half: by radii from place to place an
// estimate holds as many photons, so is as noisy, on either half; by one for all, the twin, the dim
// half is 4 times as noisy. Photons are independent, so theory has the means (analytic F1).
TEST(GatherPoints, RefocusedLightIsAsEvenWhereItIsThin) {
    constexpr std::size_t kDim = 8'000;
    constexpr std::uint32_t kPhotons = 100;
    SceneMaker maker;
    maker.quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, maker.diffuse(Rgb(0.5f)));
    maker.camera({0, 0, 3}, {0, 0, 0}, {0, 1, 0}, 40);
    const auto scene = maker.build();
    const Camera camera(*scene, 16, 16);
    const PhotonMap none(std::span<const Photon>{});
    const IrradianceSites sites(*scene, none, 0.01f);
    std::vector<Photon> some;
    addHalf(some, -1, 16 * kDim / PilotRadius::kPilotShare, 1);
    addHalf(some, 0, kDim / PilotRadius::kPilotShare, 2);
    const PilotRadius radius(std::move(some), kPhotons, 0.1f);
    struct Moments {
        double sum = 0, squares = 0;
        int count = 0;
        double mean() const { return sum / count; }
        double spread() const { return std::sqrt(squares / count / (mean() * mean()) - 1); }
    };
    std::array<Moments, 2> bright, dim;  // by radii from place to place, by one
    for (std::uint64_t seed = 3; seed < 7; ++seed) {
        std::vector<Photon> photons;
        addHalf(photons, -1, 16 * kDim, 2 * seed);
        addHalf(photons, 0, kDim, 2 * seed + 1);
        const PhotonMap map(std::move(photons));
        const SurfaceEstimate estimate(*scene, map, radius.typical());
        GatherPoints::Request request{16, 16, 2.5f, 1};
        request.refocused = &estimate;
        request.refocusedRadius = &radius;
        const GatherPoints points(*scene, camera, sites, request);
        for (int i = 0; i < 49; ++i) {
            const float x = 0.26f + 0.08f * static_cast<float>(i % 7);
            const float y = -0.75f + 0.25f * static_cast<float>(i / 7);
            for (const float side : {-1.0f, 1.0f}) {
                const Vec3f at{side * x, y, 0}, normal{0, 0, 1};
                auto& moments = side < 0 ? bright : dim;
                const auto add = [](Moments& m, const TwoRadii& e) {
                    const auto value = static_cast<double>(e.wide.r);
                    m.sum += value, m.squares += value * value, ++m.count;
                };
                const GatherPoints::Place place{{}, at, normal, normal, 1e-6f};
                add(moments[0], points.refocusedAt(place, kNothingNear, 1));
                add(moments[1], estimate.at(at, normal, 1));
            }
        }
    }
    fmt::print("    spread {:.3f} and {:.3f} in the dim half, by one radius {:.3f} and {:.3f}\n",
               bright[0].spread(), dim[0].spread(), bright[1].spread(), dim[1].spread());
    const double irradiance = kDim * 1e-4 / 2;
    EXPECT_NEAR(bright[0].mean() / (16 * irradiance), 1, 4 * bright[0].spread() / 14);
    EXPECT_NEAR(dim[0].mean() / irradiance, 1, 4 * dim[0].spread() / 5);
    EXPECT_LT(dim[0].spread(), 1.6 * bright[0].spread());
    EXPECT_GT(dim[1].spread(), 2.5 * bright[1].spread());
}

// Which share of the gather rays from a place meets a sphere that shines: the form factor,
// (R/d)^2 cos(theta) while it stands above the horizon (analytic A4). So the rays' directions
// follow the cosine, wherever the floor's normal points.
TEST(GatherPoints, RaysFollowTheCosine) {
    struct Direction {
        double degrees, turns;
    };
    double chiSquared = 0, flat = 0;
    int count = 0;
    for (const Vec3d& normal : {Vec3d{0, 1, 0}, normalize(Vec3d{0.6, 0.2, -0.4})})
        for (const Direction& d : {Direction{0, 0}, {30, 0.1}, {30, 0.6}, {50, 0.3}, {65, 0.85}}) {
            const Frame frame{Vec3f(normal)};
            const Vec3d t(frame.tangent), b(frame.bitangent);
            const double theta = d.degrees * std::numbers::pi / 180;
            const double phi = 2 * std::numbers::pi * d.turns;
            const Vec3d to = normal * std::cos(theta) +
                             (t * std::cos(phi) + b * std::sin(phi)) * std::sin(theta);
            SceneMaker maker;
            const double half = 0.01;
            maker.quad((t + b) * -half, t * (2 * half), b * (2 * half), maker.diffuse(Rgb(0.5f)));
            maker.sphere(to * 2.5, 1, maker.diffuse({}, Rgb(1.0f)));
            maker.camera(normal * 0.5, {0, 0, 0}, t, 0.5);
            const auto scene = maker.build();
            const Camera camera(*scene, 16, 16);
            const PhotonMap map(std::span<const Photon>{});
            const IrradianceSites sites(*scene, map, 0.01f);
            const GatherPoints points(*scene, camera, sites, {16, 16, 2.5f, 64});
            const auto onFloor = Vec3f(-scene->centre());
            double share = 0;
            int places = 0;
            for (int y = 0; y < 16; ++y)
                for (int x = 0; x < 16; ++x) {
                    const Vec2f screen{static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f};
                    Surface surface;
                    ASSERT_TRUE(scene->intersect(
                        camera.ray({static_cast<double>(screen.x), static_cast<double>(screen.y)}),
                        surface));
                    GatherPoints::Estimate found;
                    ASSERT_TRUE(points.estimate({screen, surface.position, Vec3f(normal),
                                                 surface.geometricNormal, surface.offset},
                                                found));
                    ASSERT_LT(length(surface.position - onFloor), 0.02f);
                    share += static_cast<double>(found.lampShare);
                    ++places;
                }
            share /= places;
            const double expected = std::cos(theta) / 6.25;
            const auto rays = static_cast<double>(points.raysTraced());
            // Of independent rays; these are spread better.
            const double variance = expected * (1 - expected) / rays;
            chiSquared += (share - expected) * (share - expected) / variance;
            // Twin: as often from everywhere, 1 - cos of the sphere's half angle.
            const double even = 1 - std::sqrt(1 - 1 / 6.25);
            flat += (share - even) * (share - even) / variance;
            ++count;
        }
    fmt::print("    chi-squared {:.1f} of {} spheres, {:.0f} without the cosine\n", chiSquared,
               count, flat);
    EXPECT_GT(chiSquaredPValue(chiSquared, count), 0.01 / 50);
    EXPECT_LT(chiSquaredPValue(flat, count), 0.01 / 50);
}

// How many samples of a floor have no point near, by their distance from its wall, in pixels.
// Those have few rays of their own and made corners speckled.
TEST(GatherPoints, FewSamplesBesideAWallAreWithout) {
    constexpr std::int32_t kPixels = 64;
    SceneMaker maker;
    maker.quad({0, 0, 1}, {1, 0, 0}, {0, 0, -2}, maker.diffuse(Rgb(0.5f)));
    maker.quad({0, 0, 1}, {0, 0, -2}, {0, 1, 0}, maker.diffuse(Rgb(0.5f)));
    // A pixel of the floor is 1/64.
    maker.camera({0.4, 5, 0}, {0.4, 0, 0}, {0, 0, -1}, 2 * std::atan(0.1) * 180 / std::numbers::pi);
    const auto scene = maker.build();
    const Camera camera(*scene, kPixels, kPixels);
    const PhotonMap map(std::span<const Photon>{});
    const IrradianceSites sites(*scene, map, 0.01f);
    const GatherPoints points(*scene, camera, sites, {kPixels, kPixels, 2.5f, 32});
    std::array<int, 6> samples{}, without{};
    Random random(1);
    for (int i = 0; i < 20'000; ++i) {
        const Vec2f screen{kPixels * random.next(), kPixels * random.next()};
        Surface surface;
        if (!scene->intersect(
                camera.ray({static_cast<double>(screen.x), static_cast<double>(screen.y)}),
                surface) ||
            surface.shape != 0)
            continue;
        const double x = static_cast<double>(surface.position.x) + scene->centre().x;
        const auto pixels = static_cast<std::size_t>(x * kPixels);
        if (pixels >= samples.size()) continue;
        GatherPoints::Estimate found;
        without[pixels] += !points.estimate({screen, surface.position, surface.geometricNormal,
                                             surface.geometricNormal, surface.offset},
                                            found);
        ++samples[pixels];
    }
    std::array<double, 6> share{};
    for (std::size_t i = 0; i < share.size(); ++i)
        share[i] = static_cast<double>(without[i]) / samples[i];
    fmt::print("    without a point: {:.3f}\n", fmt::join(share, ", "));
    // With a reach of 0.7 clearances they are 0.45, 0.26 and 0.04; sigma is 0.013 at most here.
    EXPECT_LT(share[0], 0.11);
    EXPECT_LT(share[1], 0.08);
    for (std::size_t i = 2; i < share.size(); ++i) EXPECT_LT(share[i], 0.01) << i;
}

// Beyond the frame there are no points, and the light is the same.
TEST(GatherPoints, Overscan) {
    SceneMaker maker = openRoom();
    ceilingLamp(maker, 0.5, Rgb(8.0f));
    maker.camera({0, 0, 0.9}, {0, 0, -1}, {0, 1, 0}, 50);
    const auto scene = maker.build();
    const std::vector<Rect> beyond = {{-24, 0, -12, 24}, {24, 0, 36, 24}, {-12, -16, 0, -8},
                                      {-2, -2, 0, 26},   {0, 24, 24, 36}, {24, 24, 40, 40}};
    const auto renders = [&](IntegratorKind integrator, std::uint32_t level) {
        return replicate(16, [&](std::uint64_t seed) {
            RenderSettings settings = smallFrame(24, 24, integrator, 2, level);
            settings.seed = seed;
            return render(scene, settings, beyond);
        });
    };
    const auto photon = renders(IntegratorKind::kPhoton, 4),
               path = renders(IntegratorKind::kPath, 5);
    expectAgreement(photon, path, kDirect, 0, 4, "overscan");
    expectAgreement(photon, path, kIndirect, 0.02, 4, "overscan");
}

}  // namespace
}  // namespace pm::test
