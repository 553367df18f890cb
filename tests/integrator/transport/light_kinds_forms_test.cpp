// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Spots, directional lights and environments against closed forms, by both integrators.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

#include "integrator/sampling/warps.h"
#include "tests/support/rooms.h"
#include "tests/support/scene_maker.h"
#include "tests/support/sky_picture.h"

namespace pm::test {
namespace {

constexpr double kPiD = std::numbers::pi;
constexpr float kRho = 0.5f;

class LightKindForm : public ::testing::TestWithParam<IntegratorKind> {
  protected:
    MeasuredLayers render(const SceneMaker& maker) const {
        RenderSettings settings = smallFrame(16, 16, GetParam(), 8, 4);
        settings.photons = 10'000;
        return measure(maker.build(), settings);
    }
    // The frame shows a surface that reflects kRho of irradiance E, all of it straight from lights.
    void expectIrradiance(const SceneMaker& maker, double irradiance, double allowed,
                          const char* what) const {
        const MeasuredLayers m = render(maker);
        const auto radiance = static_cast<float>(static_cast<double>(kRho) / kPiD * irradiance);
        EXPECT_TRUE(agrees(m.direct, Rgb(radiance), allowed)) << what;
        EXPECT_TRUE(agrees(m.beauty, Rgb(radiance), allowed)) << what;
        EXPECT_LT(m.direct.standardError[0], 0.01 * static_cast<double>(radiance)) << what;
    }
};

INSTANTIATE_TEST_SUITE_P(Both, LightKindForm,
                         ::testing::Values(IntegratorKind::kPhoton, IntegratorKind::kPath),
                         [](const auto& info) {
                             return info.param == IntegratorKind::kPhoton ? "photon" : "path";
                         });

// A small patch at `at` that faces up, seen from a little above it.
void addPatch(SceneMaker& maker, Vec3d at) {
    const double half = 1e-3;
    maker.quad({-half, -half, 0}, {2 * half, 0, 0}, {0, 2 * half, 0}, maker.diffuse(Rgb(kRho)));
    // Vertices are floats, places are not.
    Transform& transform = maker.description.instances.back().transform;
    transform = {1, 0, 0, at.x, 0, 1, 0, at.y, 0, 0, 1, at.z};
    maker.camera(at + Vec3d{0, 0, 0.1}, at, {0, 1, 0},
                 2 * std::atan(half * 0.5 / 0.1) * 180 / kPiD);
}

const std::array<Vec3d, 2> kPlaces = {Vec3d{0, 0, 0}, {3e6, -2e6, 1e6}};

// E = I s cos(theta) / d^2, s = 3 t^2 - 2 t^3 where the cone fades.
TEST_P(LightKindForm, Spot) {
    for (const Vec3d& at : kPlaces)
        for (const double off : {0.0, 0.2, 0.35, 0.55}) {
            SceneMaker maker;
            addPatch(maker, at);
            // From 2 above, at an angle of 30 degrees, and `off` from the spot's axis.
            const double theta = kPiD / 6;
            const Vec3d to{std::sin(theta), 0, std::cos(theta)};
            const Vec3d across{0, 1, 0};
            maker.spot(at + to * 2.0, across * std::sin(off) - to * std::cos(off), Rgb(3.0f), 0.5,
                       0.25);
            const double t = std::clamp(
                (std::cos(off) - std::cos(0.5)) / (std::cos(0.25) - std::cos(0.5)), 0.0, 1.0);
            const double e = 3 * t * t * (3 - 2 * t) * std::cos(theta) / 4;
            if (e > 0)
                expectIrradiance(maker, e, 2e-3, "spot");
            else
                EXPECT_EQ(render(maker).beauty.mean[0], 0);
        }
}

// So many that each place has its own choice of them: some shine past the patch.
TEST_P(LightKindForm, ManySpots) {
    SceneMaker maker;
    addPatch(maker, {});
    double e = 0;
    for (int i = 0; i < 48; ++i) {
        const double turn = 2.4 * i, theta = 0.02 * i, off = 0.1 * (i % 7);
        const Vec3d to{std::sin(theta) * std::cos(turn), std::sin(theta) * std::sin(turn),
                       std::cos(theta)};
        const Vec3d across = normalize(cross(to, {1, 0.2, 0.1}));
        const double d = 1 + 0.05 * i;
        maker.spot(to * d, across * std::sin(off) - to * std::cos(off),
                   Rgb(1.0f + 0.1f * static_cast<float>(i)), 0.45, 0.25);
        const double t = std::clamp(
            (std::cos(off) - std::cos(0.45)) / (std::cos(0.2) - std::cos(0.45)), 0.0, 1.0);
        e += (1 + 0.1 * i) * t * t * (3 - 2 * t) * std::cos(theta) / (d * d);
    }
    expectIrradiance(maker, e, 2e-3, "many spots");
}

// E cos(theta), whatever the disc: what it sends sums to its axis. Across the horizon, nothing.
TEST_P(LightKindForm, Directional) {
    for (const Vec3d& at : kPlaces)
        for (const double radius : {0.0, 0.2665 * kPiD / 180, 0.4})
            for (const double degrees : {0.0, 60.0}) {
                SceneMaker maker;
                addPatch(maker, at);
                const double theta = degrees * kPiD / 180;
                maker.sun({std::sin(theta), 0, -2 * std::cos(theta) / 2}, Rgb(2.0f), radius);
                expectIrradiance(maker, 2 * std::cos(theta), 1e-4, "directional");
            }
    SceneMaker below;
    addPatch(below, {});
    below.sun({0.1, 0, 1}, Rgb(2.0f), 0.2);
    EXPECT_EQ(render(below).beauty.mean[0], 0);
}

// What is straight transparent, above the patch and the camera: black, half of a mirror, leaning.
void addSheet(SceneMaker& maker, double height, float transparency, MaterialKind kind) {
    MaterialDescription sheet;
    sheet.kind = kind;
    sheet.glossy = Rgb(kind == MaterialKind::kMirror ? 0.4f : 0.0f);
    sheet.transparency = transparency;
    maker.quad({-5, -5, height}, {10, 0, 0.3}, {0, 10, 0.2}, maker.material(sheet));
}

// Lamps without extent shine through sheets by the product of their shares, however they face.
TEST(PathForm, SheetsUnderPointsAndBeams) {
    const auto beauty = [](const SceneMaker& maker) {
        return measure(maker.build(), smallFrame(8, 8, IntegratorKind::kPath, 4, 2)).beauty;
    };
    for (int lamp = 0; lamp < 4; ++lamp) {
        SceneMaker open;
        addPatch(open, {});
        if (lamp == 0) open.sun({0.3, 0, -1}, Rgb(2.0f), 0);
        if (lamp == 1) open.pointLight({0.5, 0.5, 9}, Rgb(90.0f));
        if (lamp == 2) open.spot({0, 0.5, 9}, {0, -0.5, -9}, Rgb(90.0f), 0.2, 0.1);
        // An extended one is met by the paths that go on straight, and must not count twice.
        if (lamp == 3) open.quad({-1, -1, 9}, {0, 2, 0}, {2, 0, 0}, open.diffuse({}, Rgb(9.0f)));
        SceneMaker one = open, two = open, opaque = open;
        addSheet(one, 2, 0.3f, MaterialKind::kSurface);
        addSheet(two, 2, 0.3f, MaterialKind::kSurface);
        addSheet(two, 4, 0.6f, MaterialKind::kMirror);
        addSheet(opaque, 2, 0.3f, MaterialKind::kSurface);
        addSheet(opaque, 4, 0.0f, MaterialKind::kSurface);
        const Measured whole = beauty(open);
        const auto share = [&](float of) { return Rgb(static_cast<float>(whole.mean[0]) * of); };
        const double noise = 4 * whole.standardError[0] / whole.mean[0];
        EXPECT_TRUE(agrees(beauty(one), share(0.3f), 1e-5 + noise)) << lamp;
        EXPECT_TRUE(agrees(beauty(two), share(0.18f), 1e-5 + noise)) << lamp;
        EXPECT_EQ(beauty(opaque).mean[0], 0) << lamp;
    }
}

// A disc seen: radiance E / (pi sin^2), and nothing beside it. Analytic B7 read backwards.
TEST_P(LightKindForm, DiscIsSeen) {
    const double radius = 0.1;
    for (const double off : {0.0, 0.25}) {
        SceneMaker maker;
        maker.quad({-1, -1, 5}, {2, 0, 0}, {0, 2, 0}, maker.diffuse(Rgb(kRho)));  // behind
        maker.sun({0, 0, 1}, Rgb(2.0f), radius);
        maker.camera({0, 0, 0}, {std::sin(off), 0, -std::cos(off)}, {0, 1, 0}, 5);
        const MeasuredLayers m = render(maker);
        const double seen = 2 / (kPiD * std::sin(radius) * std::sin(radius));
        EXPECT_TRUE(agrees(m.emission, Rgb(off == 0 ? static_cast<float>(seen) : 0.0f), 1e-5));
        EXPECT_TRUE(agree(m.beauty, m.emission, 1e-6));
    }
}

// Analytic B5: E = pi L.
TEST_P(LightKindForm, ConstantEnvironment) {
    for (const Vec3d& at : kPlaces) {
        SceneMaker maker;
        addPatch(maker, at);
        maker.sky(Rgb(1.0f));
        expectIrradiance(maker, kPiD, 1e-4, "B5");
    }
}

// Analytic B6, from a picture: L = (1 + 2 cos)/3 over the horizon, E = 7 pi / 9. The picture's up
// lies along +y and is turned to where the patch faces.
TEST_P(LightKindForm, OvercastPicture) {
    constexpr std::uint32_t kRows = 256;
    const auto sky =
        std::make_shared<const SkyPicture>(4, kRows, [](std::uint32_t, std::uint32_t y) {
            const double up = -std::cos(kPiD * (y + 0.5) / kRows);
            return Rgb(up > 0 ? static_cast<float>((1 + 2 * up) / 3) : 0.0f);
        });
    SceneMaker maker;
    addPatch(maker, {});
    maker.sky(Rgb(1.0f), sky, {1, 0, 0, 0, 0, 0, -1, 0, 0, 1, 0, 0});
    // Light at the horizon, blurred over a row of texels, counts by its cosine.
    expectIrradiance(maker, 7 * kPiD / 9, 5e-4, "B6");
}

// Analytic C2: in even surroundings a convex white body, a mirror and a glass without absorption
// are invisible.
TEST_P(LightKindForm, WhiteFurnace) {
    const auto image = [&](const auto& add) {
        SceneMaker maker;
        add(maker);
        maker.sky({0.5f, 1.0f, 2.0f});
        maker.camera({0, 0, 4}, {0, 0, 0}, {0, 1, 0}, 40);
        return render(maker).beauty;
    };
    const Rgb want{0.5f, 1.0f, 2.0f};
    EXPECT_TRUE(agrees(image([](SceneMaker& m) {
                           m.sphere({0, 0, 0}, 1, m.diffuse(Rgb(1.0f)));
                       }),
                       want, 0));
    EXPECT_TRUE(agrees(image([](SceneMaker& m) {
                           m.sphere({0, 0, 0}, 1, m.material(mirror(1.0f)));
                       }),
                       want, 1e-6));
    // Paths inside glass end by the roulette, which keeps the mean.
    EXPECT_TRUE(agrees(image([](SceneMaker& m) {
                           m.sphere({0, 0, 0}, 1, m.material(glass()));
                       }),
                       want, 1e-5));
    // Half of the light on a convex grey body.
    const Measured grey = image([](SceneMaker& m) {
        m.box({-1, -1, -1}, {1, 1, 1}, m.diffuse(Rgb(0.5f)), false);
        m.quad({-9, -9, -1.0}, {0.001, 0, 0}, {0, 0.001, 0}, m.diffuse(Rgb(0.5f)));
    });
    EXPECT_LT(grey.mean[1], 1.0);
}

// Analytic D6: radiance inside glass is n^2 that outside; seen by a camera in the ball.
TEST_P(LightKindForm, RadianceInsideGlass) {
    SceneMaker maker;
    maker.sphere({0, 0, 0}, 1, maker.material(glass()));
    maker.sky(Rgb(1.0f));
    maker.camera({0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 40);
    EXPECT_TRUE(agrees(render(maker).beauty, Rgb(2.25f), 1e-5));
}

// A floor that two lights share has the sum of what each brings alone (analytic B8).
TEST_P(LightKindForm, LightsAddUp) {
    const auto with = [&](bool spot, bool sun, bool sky) {
        SceneMaker maker;
        addPatch(maker, {});
        if (spot) maker.spot({0, 1, 2}, {0, -1, -2}, Rgb(5.0f), 0.3, 0.3);
        if (sun) maker.sun({0.5, 0.2, -1}, Rgb(2.0f), 0.1);
        if (sky) maker.sky(Rgb(1.0f));
        return render(maker).beauty;
    };
    const Measured all = with(true, true, true);
    double sum = 0;
    for (int i = 0; i < 3; ++i) sum += with(i == 0, i == 1, i == 2).mean[0];
    EXPECT_TRUE(agrees(all, Rgb(static_cast<float>(sum)), 1e-3));
}

}  // namespace
}  // namespace pm::test
