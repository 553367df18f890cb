// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Density estimates of independent photons on an evenly lit plane, where theory says all about
// them: no bias (analytic F1), which an estimate that counts the photon that made its radius, or
// the one it stands on, has (F2).
#include "integrator/photons/estimate/caustic_map.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "tests/support/scene_maker.h"
#include "tests/support/statistics.h"

namespace pm::test {
namespace {

// Photons that make an irradiance of 1 on the unit square.
std::vector<Photon> evenly(std::size_t count, std::uint64_t seed) {
    Random random(seed);
    std::vector<Photon> photons;
    for (std::size_t i = 0; i < count; ++i) {
        const Vec2f at = random.next2D();
        photons.push_back(
            {{at.x, at.y, 0}, Rgb(1.0f / static_cast<float>(count)), PackedNormal(Vec3f{0, 0, 1})});
    }
    return photons;
}

struct Mean {
    double sum = 0, squares = 0, count = 0;

    void add(double v) { sum += v, squares += v * v, count += 1; }
    double mean() const { return sum / count; }
    double deviation() const { return std::sqrt(squares / count - mean() * mean()); }
};

TEST(CausticMap, MeanOfAnEvenlyLitPlane) {
    constexpr std::size_t kCount = 200'000;
    for (const std::uint32_t k : {16u, 50u}) {
        const PilotRadius radius(evenly(kCount / PilotRadius::kPilotShare, 1), k, 0.1f);
        const CausticMap map(evenly(kCount, 2), radius, 1);
        NearestPhotons scratch;
        Random random(3);
        Mean wide, narrow;
        for (int i = 0; i < 20'000; ++i) {
            const Vec2f at = random.next2D();
            const TwoRadii e =
                map.irradiance({0.1f + 0.8f * at.x, 0.1f + 0.8f * at.y, 0}, {0, 0, 1}, scratch);
            wide.add(static_cast<double>(e.wide.r));
            narrow.add(static_cast<double>(e.narrow.r));
        }
        fmt::print("    k = {}: {:.4f} of E, at the narrow radius {:.4f}, deviation {:.3f}\n", k,
                   wide.mean(), narrow.mean(), wide.deviation());
        // Some 2000 discs' worth of independent photons; k/(k-1) would be 2 % or more off.
        const double error = 1 / std::sqrt(0.64 * kCount);
        EXPECT_NEAR(wide.mean(), 1, 4 * error + 0.002);
        EXPECT_NEAR(narrow.mean(), 1, 4 * error + 0.002);
    }
}

// A disc of light on a dim floor. Discs that hold k photons reach it from everywhere beside it, so
// that it lights a rim of its surroundings; radii that grow more slowly than the way there don't.
TEST(CausticMap, ABrightDiscHasNoRimOfLight) {
    constexpr std::size_t kCount = 400'000;
    constexpr float kRadius = 0.05f, kDimShare = 1.0f / 32;
    const auto lit = [](std::size_t count, std::uint64_t seed) {
        const auto dim = static_cast<std::size_t>(kDimShare * static_cast<float>(count));
        std::vector<Photon> photons = evenly(dim, seed);
        const Photon first = photons.front();
        Random random(seed + 100);
        while (photons.size() < count) {
            const Vec2f u = random.next2D();
            const float r = kRadius * std::sqrt(u.x), angle = 2 * kPi * u.y;
            photons.push_back({{0.5f + r * std::cos(angle), 0.5f + r * std::sin(angle), 0},
                               first.flux,
                               first.normal});
        }
        return photons;
    };
    const PilotRadius radius(lit(kCount / PilotRadius::kPilotShare, 1), 50, 0.1f);
    const CausticMap map(lit(kCount, 2), radius, 1);
    const double inside = (1 / kDimShare - 1) / (std::numbers::pi * kRadius * kRadius);
    NearestPhotons scratch;
    Random random(3);
    // Of the disc's irradiance, at this distance from its middle.
    const auto shareAt = [&](float distance) {
        Mean mean;
        for (int i = 0; i < 4000; ++i) {
            const float angle = 2 * kPi * random.next2D().x;
            const Vec3f at{0.5f + distance * std::cos(angle), 0.5f + distance * std::sin(angle), 0};
            mean.add(static_cast<double>(map.irradiance(at, {0, 0, 1}, scratch).wide.r) / inside);
        }
        fmt::print(" {:.4f}", mean.mean());
        return mean.mean();
    };
    const float width = radius.typical() / kRadius;  // of the disc's own estimates
    fmt::print("    within and at 1, 1.5, 2, 3 typical radii from the edge:");
    EXPECT_NEAR(shareAt(0.5f * kRadius), 1, 0.02);
    std::array<double, 4> beside{};
    std::ranges::transform(std::array{1.0f, 1.5f, 2.0f, 3.0f}, beside.begin(),
                           [&](float way) { return shareAt(kRadius * (1 + way * width)); });
    fmt::print(", the floor has {:.4f}\n", 1 / inside);
    // Further than the widest of the rim's own radii, of 12 photons each, nothing of the disc
    // counts. As far as k photons reach there would be 0.15, 0.11 and 0.06.
    EXPECT_LT(beside[1], 0.03);
    EXPECT_LT(beside[2], 0.002);
    EXPECT_NEAR(beside[3] * inside, 1, 0.5);  // some 200 photons on the floor, seen in clumps
}

// What half of the photons need to find k others: k - 1/3 (the median of a gamma distribution) are
// expected on that disc. To find themselves would make it k - 4/3.
TEST(PilotRadius, LeavesOutThePhotonItStandsOn) {
    constexpr std::size_t kCount = 100'000;
    Mean ratio;
    for (std::uint64_t seed = 1; seed <= 8; ++seed) {
        const PhotonMap map(evenly(kCount, seed));
        const auto r = static_cast<double>(map.typicalRadius(6));
        ratio.add(std::numbers::pi * r * r * kCount / (6 - 1 / 3.0));
    }
    fmt::print("    {:.4f} of the area expected\n", ratio.mean());
    EXPECT_NEAR(ratio.mean(), 1, 0.05);
}

// A point lamp and a mirror above a floor: beside the lamp's own light (layer `direct`) the floor
// has that of its image, as far above the mirror as the lamp is below it: I cos / d^2, smooth up to
// the floor's edges. The lamp is at height 1, the mirror at 2.
TEST(CausticMap, SmoothUpToTheEdgesOfAFloor) {
    constexpr int kSide = 64;
    constexpr double kEye = 1.9, kHalf = 1.0, kSeen = 1.02;
    SceneMaker maker;
    maker.quad({-kHalf, 0, kHalf}, {2 * kHalf, 0, 0}, {0, 0, -2 * kHalf}, maker.diffuse(Rgb(0.5f)));
    MaterialDescription mirror;
    mirror.kind = MaterialKind::kMirror;
    mirror.glossy = Rgb(1.0f);
    maker.quad({-0.36, 2, -0.36}, {0.72, 0, 0}, {0, 0, 0.72}, maker.material(mirror));
    maker.pointLight({0, 1, 0}, Rgb(1.0f));
    maker.camera({0, kEye, 0}, {0, 0, 0}, {0, 0, -1},
                 2 * std::atan(kSeen / kEye) * 180 / std::numbers::pi);
    RenderSettings settings = smallFrame(kSide, kSide, IntegratorKind::kPhoton, 4, 3);
    settings.photons = 40'000;
    const struct {
        const char* name;
        Rect region;
    } kRegions[] = {
        {"middle", {24, 24, 40, 40}}, {"edge", {16, 1, 48, 3}}, {"corner", {1, 1, 3, 3}}};
    std::vector<Rect> regions;
    for (const auto& r : kRegions) regions.push_back(r.region);
    const auto measured = measureRegions(maker.build(), settings, {0, 0, kSide, kSide}, regions);
    for (std::size_t i = 0; i < regions.size(); ++i) {
        Mean expected;
        for (std::int32_t y = regions[i].y0; y < regions[i].y1; ++y)
            for (std::int32_t x = regions[i].x0; x < regions[i].x1; ++x) {
                const double px = kSeen * ((x + 0.5) / kSide * 2 - 1);
                const double pz = kSeen * ((y + 0.5) / kSide * 2 - 1);
                const double d2 = 9 + px * px + pz * pz;
                expected.add(0.5 / std::numbers::pi * 3 / (d2 * std::sqrt(d2)));
            }
        const Measured& caustic = measured[i].caustic;
        fmt::print("    {}: {:.3f} of what is expected, +- {:.3f}\n", kRegions[i].name,
                   caustic.mean[0] / expected.mean(), caustic.standardError[0] / expected.mean());
        EXPECT_NEAR(caustic.mean[0], expected.mean(),
                    0.05 * expected.mean() + 3 * caustic.standardError[0])
            << kRegions[i].name;
    }
}

}  // namespace
}  // namespace pm::test
