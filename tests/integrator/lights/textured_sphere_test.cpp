// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Spheres with a texture, and lamps among them: by shadow rays, by rays that meet them and by
// photons they shine alike. Textures of one half against closed forms.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "integrator/light_sampling/light_sampler.h"
#include "tests/support/aimed.h"
#include "tests/support/scene_maker.h"
#include "tests/support/sky_picture.h"
#include "tests/support/statistics.h"

namespace pm::test {
namespace {

constexpr double kPiD = std::numbers::pi;
constexpr float kRho = 0.5f;
constexpr std::uint32_t kTexels = 64;

enum class Lit { kLowerHalf, kRightHalf };

std::shared_ptr<const TextureSource> halfLit(Lit lit) {
    return std::make_shared<const SkyPicture>(
        kTexels, kTexels, [lit](std::uint32_t x, std::uint32_t y) {
            const bool shines = lit == Lit::kLowerHalf ? y < kTexels / 2 : x >= kTexels / 2;
            return shines ? Rgb(1.0f) : Rgb{};
        });
}

// A lamp of radius 1 two units above the origin, turned about z by that angle.
void addLamp(SceneMaker& maker, Lit lit, double turn) {
    MaterialDescription lamp;
    lamp.emission = Rgb(1.0f);
    lamp.emissionTexture = 0;
    maker.description.textures = halfLit(lit);
    maker.sphere({0, 0, 0}, 1, maker.material(lamp));
    const double c = std::cos(turn), s = std::sin(turn);
    maker.description.instances.back().transform = {c, -s, 0, 0, s, c, 0, 2, 0, 0, 1, 0};
}

void addFloor(SceneMaker& maker, double half) {
    maker.quad({-half, 0, half}, {2 * half, 0, 0}, {0, 0, -2 * half}, maker.diffuse(Rgb(kRho)));
}

// Irradiance at the origin of a floor that looks up: pi L (R/d)^2 of a whole lamp. The lower half
// is all that it sees; of left and right it sees as much.
struct Case {
    const char* name;
    Lit lit;
    double turn, irradiance;
};

const Case kCases[] = {
    {"lower half", Lit::kLowerHalf, 0.0, kPiD / 4},
    {"lower half on top", Lit::kLowerHalf, kPiD, 0.0},
    {"right half", Lit::kRightHalf, 0.0, kPiD / 8},
    {"right half below", Lit::kRightHalf, -kPiD / 2, kPiD / 4},
    {"right half on top", Lit::kRightHalf, kPiD / 2, 0.0},
};

TEST(TexturedSphere, IlluminatesWithWhatShines) {
    for (const Case& c : kCases)
        for (const auto integrator : {IntegratorKind::kPhoton, IntegratorKind::kPath}) {
            SceneMaker maker;
            addLamp(maker, c.lit, c.turn);
            addFloor(maker, 1e-3);
            maker.camera({0, 0.1, 0}, {0, 0, 0}, {0, 0, -1}, 0.4);
            RenderSettings settings = smallFrame(16, 16, integrator, 8, 4);
            settings.photons = 10'000;
            const auto expected =
                static_cast<float>(static_cast<double>(kRho) / kPiD * c.irradiance);
            const MeasuredLayers m = measure(maker.build(), settings);
            // Texels are interpolated where the halves meet: a quarter's mean is off by 1e-3.
            EXPECT_TRUE(agrees(m.beauty, Rgb(expected), 1e-3)) << c.name;
            EXPECT_LE(m.beauty.standardError[0], 0.01 * static_cast<double>(expected)) << c.name;
        }
}

TEST(TexturedSphere, PhotonsLandAsIrradiance) {
    for (const Case& c : kCases) {
        SceneMaker maker;
        addLamp(maker, c.lit, c.turn);
        addFloor(maker, 0.15);
        const Aimed aimed(maker.build(), false);
        constexpr double kPhotons = 400'000;
        const PhotonTraceResult traced =
            aimed.trace(PhotonKind::kGlobal, static_cast<std::uint64_t>(kPhotons), 1, false);
        double flux = 0;
        for (const Photon& p : traced.photons) flux += static_cast<double>(p.flux.r);
        // Of photons of equal flux, some 700 land on the floor; .01: it isn't a point.
        const double each = 4 * kPiD * kPiD / kPhotons, expected = c.irradiance * 0.09;
        EXPECT_NEAR(flux, expected, 4 * std::sqrt(each * expected) + 0.01 * expected) << c.name;
        // Half of the lamp's area shines.
        EXPECT_NEAR(traced.balance.fluxEmitted / 3, 2 * kPiD * kPiD,
                    4 * 2 * kPiD * kPiD / std::sqrt(kPhotons))
            << c.name;
    }
}

// What next-event estimation takes for radiance is what a ray in that direction finds, anywhere.
TEST(TexturedSphere, IsSampledAsItIsSeen) {
    for (const Case& c : kCases) {
        SceneMaker maker;
        addLamp(maker, c.lit, c.turn);
        addFloor(maker, 3.0);
        const auto scene = maker.build();
        const LightSampler lights(*scene);
        Random random(1);
        int unlike = 0, lit = 0, turnedAway = 0;
        constexpr int kSamples = 10'000;
        for (int i = 0; i < kSamples; ++i) {
            const Vec3d above{6 * static_cast<double>(random.next()) - 3, 0.1,
                              6 * static_cast<double>(random.next()) - 3};
            Surface floor, lamp;
            LightSample sample;
            ASSERT_TRUE(scene->intersect({Vec3f(above - scene->centre()), {0, -1, 0}}, floor));
            // What the texture asks for may face away.
            if (!lights.sample(floor, random.next2D(), sample)) {
                ++turnedAway;
                continue;
            }
            if (!scene->intersect(rayFrom(floor, sample.direction), lamp)) continue;  // the limb
            const float seen = lights.emittedRadiance(lamp, -sample.direction).g;
            unlike += std::abs(seen - sample.radiance.g) > 1e-3f;
            lit += seen > 0.5f;
        }
        EXPECT_LE(unlike, 3) << c.name;  // near the poles texels are thin
        EXPECT_GT(lit, kSamples / 100) << c.name;
        EXPECT_LT(turnedAway, kSamples / 2) << c.name;
    }
}

// The middle of the picture towards +z of the instance, its right half towards +x, its upper edge
// at +y, whatever the instance's turn, scale or mirroring; nothing without a texture.
TEST(TexturedSphere, HasLatitudeAndLongitude) {
    for (const double mirror : {1.0, -1.0})
        for (const bool textured : {true, false}) {
            SceneMaker maker;
            addLamp(maker, Lit::kLowerHalf, 0);
            Transform turn = aTurn();
            for (std::size_t row = 0; row < 3; ++row) turn[4 * row] *= mirror;
            Transform m = turn;
            for (double& value : m) value *= 2.5;
            maker.description.instances.back().transform = m;
            if (!textured) maker.description.materials[0].emissionTexture = kNoTexture;
            const auto scene = maker.build();
            struct {
                Vec3d local;
                Vec2f uv;
            } const points[] = {{{0, 0, 1}, {0.5f, 0.5f}},   {{1, 0, 0}, {0.75f, 0.5f}},
                                {{-1, 0, 0}, {0.25f, 0.5f}}, {{1, 0, 1}, {0.625f, 0.5f}},
                                {{0, 1, 1}, {0.5f, 0.75f}},  {{1e-9, -1, 1e-9}, {0.625f, 0.0f}}};
            for (const auto& [local, uv] : points) {
                const Vec3d direction{turn[0] * local.x + turn[1] * local.y + turn[2] * local.z,
                                      turn[4] * local.x + turn[5] * local.y + turn[6] * local.z,
                                      turn[8] * local.x + turn[9] * local.y + turn[10] * local.z};
                const Surface surface = scene->pointOnSphere(0, direction);
                EXPECT_NEAR(surface.uv.x, textured ? uv.x : 0.0f, 1e-6f);
                EXPECT_NEAR(surface.uv.y, textured ? uv.y : 0.0f, 1e-6f);
            }
        }
}

}  // namespace
}  // namespace pm::test
