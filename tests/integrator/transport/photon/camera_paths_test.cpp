// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Camera paths follow all lobes that carry enough: no grain where one would be chosen by chance,
// and the same mean.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <vector>

#include "integrator/transport/photon/photon_integrator.h"
#include "tests/support/rooms.h"
#include "tests/support/scene_maker.h"
#include "tests/support/statistics.h"

namespace pm::test {
namespace {

constexpr double kThickness = 0.05;
// What lobes may carry that are followed by chance, see photon_integrator.cpp.
constexpr double kLeastDivided = 0.03;

// Lamps seen along a ray that comes down at 60 degrees to where the origin is.
Moments lampsSeen(const Scene& scene) {
    constexpr std::uint32_t kCount = 20'000;
    const double sine = std::sqrt(0.75);
    const Vec3d eye{0, 0.5, sine};
    const LightSampler lights(scene);
    const PhotonIntegrator integrator(scene, lights, {});
    const Ray ray{Vec3f(eye - scene.centre()), Vec3f(-eye)};
    NearestPhotons scratch;
    return momentsOf(kCount, [&](std::uint32_t i) {
        Sampler sampler(5, 0, i, 0);
        return static_cast<double>(integrator.sample({{}, ray}, sampler, scratch).emission.g);
    });
}

// Fresnel's reflectance of glass at 60 degrees.
double reflectance() {
    const double cosine = 0.5, inside = std::sqrt(1 - 0.75 / 2.25);
    const double s = (cosine - 1.5 * inside) / (cosine + 1.5 * inside);
    const double p = (1.5 * cosine - inside) / (1.5 * cosine + inside);
    return (s * s + p * p) / 2;
}

// A pane of glass under the origin; what passes it meets nothing.
SceneMaker pane() {
    SceneMaker maker;
    const std::uint32_t material = maker.material(glass());
    maker.quad({-1, 0, 0.5}, {2, 0, 0}, {0, 0, -1.7}, material);
    maker.quad({-1, -kThickness, 0.5}, {0, 0, -1.7}, {2, 0, 0}, material);
    return maker;
}

// What a pane reflects, R + T R T + T R R R T ... = 2 R / (1 + R), is a sum of parts of which but
// two carry less than kLeastDivided. A lobe chosen by chance has the variance m - m^2.
TEST(CameraPaths, FollowBothPartsOfGlass) {
    SceneMaker maker = pane();
    maker.quad({-1, -3, -6}, {2, 0, 0}, {0, 9, 0}, maker.diffuse({}, Rgb(1.0f)));
    const Moments found = lampsSeen(*maker.build());
    const double r = reflectance(), reflected = 2 * r / (1 + r);
    const double byChance = reflected - r - (1 - r) * (1 - r) * r;
    EXPECT_NEAR(found.mean, reflected, 4 * found.standardError);
    EXPECT_LE(found.variance, 2 * kLeastDivided * byChance);
}

// The same by way of six mirrors: what is a part from glass on is not ended as if the path had lost
// the rest.
TEST(CameraPaths, RouletteSparesParts) {
    SceneMaker maker = pane();
    const std::uint32_t silver = maker.material(mirror(0.9f));
    maker.quad({-1, 0.5, -0.4}, {2, 0, 0}, {0, 0, -5.2}, silver);
    maker.quad({-1, 0, -1.2}, {2, 0, 0}, {0, 0, -4.4}, silver);
    maker.quad({-1, 0, -5.6}, {2, 0, 0}, {0, 0.5, 0}, maker.diffuse({}, Rgb(1.0f)));
    const Moments found = lampsSeen(*maker.build());
    const double r = reflectance(), reflected = 2 * r / (1 + r) * std::pow(0.9, 6);
    EXPECT_NEAR(found.mean, reflected, 4 * found.standardError);
    // Each part counts for what it carried where it began, at most.
    EXPECT_LE(found.variance, r * reflected);
}

// Under a sky of 1, along a ray that comes down to a floor at the origin.
struct UnderSky {
    double emission = 0, direct = 0, directError = 0, leastEmission = 1e9, mostEmission = 0;
};
UnderSky underSky(SceneMaker maker, const MaterialDescription& floor) {
    maker.quad({-0.01, 0, 0.01}, {0.02, 0, 0}, {0, 0, -0.02}, maker.material(floor));
    maker.sky(Rgb(1.0f));
    const auto scene = maker.build();
    const LightSampler lights(*scene);
    const PhotonIntegrator integrator(*scene, lights, {});
    const Ray ray{Vec3f(Vec3d{0, 0.5, 0.5} - scene->centre()), normalize(Vec3f(0, -0.5f, -0.5f))};
    NearestPhotons scratch;
    constexpr std::uint32_t kCount = 20'000;
    UnderSky found;
    double squares = 0;
    for (std::uint32_t i = 0; i < kCount; ++i) {
        Sampler sampler(5, 0, i, 0);
        const SampleRadiance seen = integrator.sample({{}, ray}, sampler, scratch);
        const auto emission = static_cast<double>(seen.emission.g);
        const auto direct = static_cast<double>(seen.direct.g);
        found.emission += emission / kCount;
        found.leastEmission = std::min(found.leastEmission, emission);
        found.mostEmission = std::max(found.mostEmission, emission);
        found.direct += direct / kCount;
        squares += direct * direct / kCount;
    }
    found.directError = std::sqrt((squares - found.direct * found.direct) / kCount);
    return found;
}

// What passes a veil is followed for sure; what its few threads reflect, rarely, at its weight.
TEST(CameraPaths, VeilsAtTheirWeights) {
    MaterialDescription veil;
    veil.diffuse = Rgb(1.0f);
    veil.transparency = 0.99f;
    const UnderSky found = underSky({}, veil);
    EXPECT_NEAR(found.leastEmission, 0.99, 1e-6);
    EXPECT_NEAR(found.mostEmission, 0.99, 1e-6);
    EXPECT_NEAR(found.direct, 0.01, 4 * found.directError);
    EXPECT_LT(found.directError, 0.01 * 0.01);
}

// A part that is followed by chance counts for more, diffuse ones, too.
TEST(CameraPaths, LesserDiffuseParts) {
    SceneMaker maker;
    MaterialDescription veil;
    veil.diffuse = Rgb(1.0f);
    veil.transparency = 0.5f;
    maker.quad({-1, 0, -0.5}, {2, 0, 0}, {0, 1, 0}, maker.material(veil));
    const UnderSky found = underSky(maker, mirror(0.02f));
    EXPECT_NEAR(found.direct, 0.01, 4 * found.directError);
    EXPECT_NEAR(found.emission, 0.01, 1e-3);
}

// Two parts of what a mirror of 0.03 leaves: always one of them, at the whole.
TEST(CameraPaths, OneOfTwoLesserParts) {
    SceneMaker maker;
    MaterialDescription half = mirror(1.0f);
    half.transparency = 0.25f;
    maker.quad({-1, 0, -0.5}, {2, 0, 0}, {0, 1, 0}, maker.material(half));
    const UnderSky found = underSky(maker, mirror(0.03f));
    EXPECT_NEAR(found.leastEmission, 0.03, 1e-6);
    EXPECT_NEAR(found.mostEmission, 0.03, 1e-6);
}

// Direct light in the centres of 16 x 16 pixels, green: one path each.
std::vector<double> directSeen(const SceneMaker& maker) {
    const auto scene = maker.build();
    const LightSampler lights(*scene);
    const PhotonIntegrator integrator(*scene, lights, PhotonMaps{});
    const Camera camera(*scene, 16, 16);
    NearestPhotons scratch;
    std::vector<double> seen;
    for (std::uint32_t i = 0; i < 256; ++i) {
        Sampler sampler(1, 0, 0, i);
        const Vec2f screen{static_cast<float>(i % 16) + 0.5f, static_cast<float>(i / 16) + 0.5f};
        const Ray ray = camera.ray({static_cast<double>(screen.x), static_cast<double>(screen.y)});
        seen.push_back(
            static_cast<double>(integrator.sample({screen, ray}, sampler, scratch).direct.g));
    }
    return seen;
}

// Of a wall of reflectance 0.5, 3 before a point light of intensity 10.
constexpr double kLitWall = 0.5 / std::numbers::pi * 10 / 9;

// A ball of glass before nothing mirrors 4 % of a lit wall, and once more from its back: all camera
// samples see it, not one in 25 at 25 times its radiance, which a bright wall would make a speck.
TEST(CameraPaths, SeeWhatGlassReflects) {
    SceneMaker maker;
    maker.sphere({0, 0, 0}, 0.5, maker.material(glass()));
    maker.quad({-20, -20, 6}, {0, 40, 0}, {40, 0, 0}, maker.diffuse(Rgb(0.5f)));
    maker.pointLight({0, 0, 3}, Rgb(10.0f));
    maker.camera({0, 0, 4}, {0, 0, 0}, {0, 1, 0}, 2);
    int dark = 0;
    double most = 0, sum = 0;
    for (const double seen : directSeen(maker)) {
        dark += seen == 0;
        most = std::max(most, seen);
        sum += seen;
    }
    EXPECT_EQ(dark, 0);
    EXPECT_GT(sum / 256 / kLitWall, 0.06);
    EXPECT_LT(sum / 256 / kLitWall, 0.1);
    EXPECT_LT(most / kLitWall, 0.2);
}

// Each part at its weight, without noise: where glass begins, a lit wall before it is mirrored at
// R = 0.04, and one in the glass shines out at (1 - R) / eta^2.
TEST(CameraPaths, DivideByTheWeightsOfBothParts) {
    for (const double side : {1.0, -1.0}) {
        SceneMaker maker;
        maker.quad({-5, -5, 0}, {10, 0, 0}, {0, 10, 0}, maker.material(glass(1.5f)));
        const auto grey = maker.diffuse(Rgb(0.5f));
        maker.quad({-5, -5, 6}, {0, 10, 0}, {10, 0, 0}, grey);
        maker.quad({-5, -5, -6}, {10, 0, 0}, {0, 10, 0}, grey);
        maker.pointLight({0, 0, 3 * side}, Rgb(10.0f));
        maker.camera({0, 0, 4}, {0, 0, 0}, {0, 1, 0}, 0.1);
        const double weight = side > 0 ? 0.04 : 0.96 / (1.5 * 1.5);
        // Half an angle of 0.05 degrees leaves 2e-5 of the wall's evenness.
        const std::vector<double> seen = directSeen(maker);
        EXPECT_NEAR(std::ranges::min(seen) / kLitWall, weight, 1e-4 * weight);
        EXPECT_NEAR(std::ranges::max(seen) / kLitWall, weight, 1e-4 * weight);
    }
}

// Photons of 1e-4 W, evenly over a parallelogram.
PhotonMap evenPhotons(const Scene& scene, Vec3d p, Vec3d e0, Vec3d e1) {
    std::vector<Photon> photons;
    Random random(3);
    for (int i = 0; i < 20'000; ++i) {
        const Vec2f at = random.next2D();
        const Vec3d place = p + e0 * static_cast<double>(at.x) + e1 * static_cast<double>(at.y);
        photons.push_back({Vec3f(place - scene.centre()), Rgb(1e-4f),
                           PackedNormal(Vec3f(normalize(cross(e0, e1))))});
    }
    return PhotonMap(photons);
}

// Indirect light along a ray to a wall under a ceiling: at once, or by way of a pane.
struct Indirect {
    Moments light;
    double rays = 0;
};
Indirect indirectSeen(bool byPane, bool isRefocused) {
    SceneMaker maker = byPane ? pane() : SceneMaker();
    const auto grey = maker.diffuse(Rgb(0.5f));
    const Vec3d wall{-1, -3, -6}, ceiling{-1, 5, -6}, wide{2, 0, 0}, high{0, 9, 0}, deep{0, 0, 5};
    maker.quad(wall, wide, high, grey);
    maker.quad(ceiling, wide, deep, grey);
    const auto scene = maker.build();
    // For the estimate at the wall itself, or for gather rays from there.
    const PhotonMap photons = isRefocused ? evenPhotons(*scene, wall, wide, high)
                                          : evenPhotons(*scene, ceiling, wide, deep);
    const PhotonMap none(std::span<const Photon>{});
    const IrradianceSites sites(*scene, isRefocused ? none : photons, 0.3f);
    const SurfaceEstimate estimate(*scene, photons, 0.3f);
    const LightSampler lights(*scene);
    const PhotonMaps maps{.global = &sites, .refocused = isRefocused ? &estimate : nullptr};
    const PhotonIntegrator integrator(*scene, lights, maps);
    const double sine = std::sqrt(0.75);
    const Vec3d from = byPane ? Vec3d{0, 0.5, sine} : Vec3d{0, 0, 0};
    const Vec3d direction = byPane ? Vec3d{0, -0.5, -sine} : Vec3d{0, 0.5, -sine};
    const Ray ray{Vec3f(from - scene->centre()), Vec3f(direction)};
    NearestPhotons scratch;
    constexpr std::uint32_t kCount = 20'000;
    Indirect seen;
    seen.light = momentsOf(kCount, [&](std::uint32_t i) {
        Sampler sampler(5, 0, i, 0);
        const SampleRadiance found = integrator.sample({{}, ray}, sampler, scratch);
        seen.rays += static_cast<double>(found.rays) / kCount;
        return static_cast<double>(found.indirect.g);
    });
    return seen;
}

// What a pane reflects is a sixth of a sample, in two parts: one gather ray of each in place of
// four, refocused light in one sample of four, and the same mean. By way of the pane's back the
// wall is seen 0.04 aside, where there are other photons and a little less of the ceiling.
TEST(CameraPaths, LittleWorkForLittleParts) {
    const double r = reflectance(), reflected = 2 * r / (1 + r);
    for (const bool isRefocused : {true, false}) {
        const Indirect once = indirectSeen(false, isRefocused);
        const Indirect part = indirectSeen(true, isRefocused);
        const double ratio = part.light.mean / once.light.mean / reflected;
        const double error = std::hypot(part.light.standardError / part.light.mean,
                                        once.light.standardError / once.light.mean);
        fmt::print("    {:.3f} +- {:.3f} of what the pane reflects, {:.2f} rays and {:.2f}\n",
                   ratio, error, part.rays, once.rays);
        EXPECT_NEAR(ratio, 1, 4 * error + 0.02);
        EXPECT_LT(error, 0.02);
        EXPECT_LE(part.rays, 9);
    }
}

}  // namespace
}  // namespace pm::test
