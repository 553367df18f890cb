// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Panes of glass from thick to far thinner than rays can tell, against Fresnel's equations.
#include <gtest/gtest.h>

#include <cmath>

#include "integrator/materials/bsdf.h"
#include "tests/support/rooms.h"
#include "tests/support/scene_maker.h"

namespace pm::test {
namespace {

// A street of 200 units, a pane of 2 units a third along it, and a wall that shines: behind the
// pane, or behind the camera.
SceneMaker paneInAStreet(double thickness, double leanDegrees, bool inFront) {
    SceneMaker maker;
    maker.quad({-100, -1, 100}, {200, 0, 0}, {0, 0, -200}, maker.diffuse(Rgb(0.0f)));
    const Vec3d at{31.7, 0.4, -12.3};
    const Vec3d shining = at + Vec3d{-4, -4, inFront ? 3.0 : -3.0};
    const Vec3d right{8, 0, 0}, up{0, 8, 0};
    maker.quad(shining, inFront ? up : right, inFront ? right : up, maker.diffuse({}, Rgb(1.0f)));
    const double lean = leanDegrees * kPi / 180;
    const Vec3d u{std::cos(lean), 0, -std::sin(lean)}, v{0, 1, 0},
        n{std::sin(lean), 0, std::cos(lean)};
    const auto material = maker.material(glass());
    const Vec3d front = at - u - v, back = front - n * thickness;
    maker.quad(front, u * 2, v * 2, material);
    maker.quad(back, v * 2, u * 2, material);
    maker.quad(front, v * 2, back - front, material);
    maker.quad(front + u * 2, back - front, v * 2, material);
    maker.quad(front, back - front, u * 2, material);
    maker.quad(front + v * 2, u * 2, back - front, material);
    maker.camera(at + Vec3d{0, 0, 2}, at, {0, 1, 0}, 2);
    return maker;
}

double throughBoth(double degrees) {
    const double r = static_cast<double>(
        fresnelDielectric(static_cast<float>(std::cos(degrees * kPi / 180)), glass().ior));
    return (1 - r) / (1 + r);
}

class Panes : public ::testing::TestWithParam<IntegratorKind> {};

INSTANTIATE_TEST_SUITE_P(Both, Panes,
                         ::testing::Values(IntegratorKind::kPhoton, IntegratorKind::kPath),
                         [](const auto& info) {
                             return info.param == IntegratorKind::kPhoton ? "photon" : "path";
                         });

TEST_P(Panes, LetThroughWhatTwoBoundariesDo) {
    RenderSettings settings = smallFrame(8, 8, GetParam(), 4, 4);
    settings.photons = 1000;
    for (const double lean : {0.0, 60.0})
        for (const double thickness : {1e-2, 1e-3, 2e-4, 5e-5, 2e-5, 1e-5, 3e-6}) {
            const auto scene = paneInAStreet(thickness, lean, false).build();
            const auto expected = static_cast<float>(throughBoth(lean));
            // A degree to the side changes what a leaning pane lets through by a thousandth.
            EXPECT_TRUE(agrees(measure(scene, settings).beauty, Rgb(expected), 2e-3))
                << thickness << " thick, " << lean << " degrees";
            EXPECT_TRUE(scene->notices().empty()) << thickness << ": " << scene->notices()[0].text;
        }
}

TEST_P(Panes, ReflectWhatTheyDoNotLetThrough) {
    RenderSettings settings = smallFrame(8, 8, GetParam(), 4, 5);
    settings.photons = 1000;
    for (const double thickness : {1e-2, 1e-4, 1e-5}) {
        const auto scene = paneInAStreet(thickness, 0, true).build();
        const auto expected = static_cast<float>(1 - throughBoth(0));
        EXPECT_TRUE(agrees(measure(scene, settings).beauty, Rgb(expected), 2e-3)) << thickness;
    }
}

}  // namespace
}  // namespace pm::test
