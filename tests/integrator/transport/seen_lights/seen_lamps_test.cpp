// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Lamps that the camera sees, straight or by way of mirrors and glass.
#include "integrator/transport/seen_lights/seen_lamps.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "integrator/light_sampling/light_sampler.h"
#include "integrator/scene/camera.h"
#include "tests/support/rooms.h"
#include "tests/support/scene_maker.h"
#include "tests/support/statistics.h"

namespace pm::test {
namespace {

constexpr std::int32_t kSize = 64;

// What a camera sees of a scene.
struct View {
    std::shared_ptr<const Scene> scene;
    Camera camera;
    LightSampler lights;
    SeenLamps lamps;

    explicit View(const SceneMaker& maker)
        : scene(maker.build()),
          camera(*scene, kSize, kSize),
          lights(*scene),
          lamps(*scene, lights, camera, {.width = kSize, .height = kSize, .errorScale = {}}) {}

    Ray ray(const Sampler& sampler) const {
        const Vec2f place = sampler.get2D(Purpose::kPlace);
        return camera.ray(
            {kSize * static_cast<double>(place.x), kSize * static_cast<double>(place.y)});
    }
};

struct Mean {
    double mean = 0, standardError = 0, raysOfAPath = 0;
};

Mean meanAlong(const View& view, std::uint32_t count) {
    std::uint32_t rays = 0;
    const Moments found = momentsOf(count, [&](std::uint32_t i) {
        // Each by a sequence of its own: independent, for the standard error.
        const Sampler sampler(7, 0, i, 0);
        const Ray ray = view.ray(sampler);
        return static_cast<double>(view.lamps.along(ray, sampler, rays).g);
    });
    return {found.mean, found.standardError, static_cast<double>(rays) / count};
}

// A surface of glass below a lamp: of each ray the share by Fresnel, never all or nothing.
TEST(SeenLamps, GlassShowsItsShareOfALampInEachPath) {
    SceneMaker maker;
    maker.quad({-50, 0, 50}, {100, 0, 0}, {0, 0, -100}, maker.material(glass()));
    maker.quad({-50, 5, -50}, {100, 0, 0}, {0, 0, 100}, maker.diffuse({}, Rgb(30.0f)));
    maker.camera({0, 2, 4}, {0, 0, 0}, {0, 1, 0}, 30);
    const View view(maker);
    std::uint32_t rays = 0;
    for (std::uint32_t i = 0; i < 200; ++i) {
        const Sampler sampler(1, 0, 0, i);
        const Ray ray = view.ray(sampler);
        const float expected = 30.0f * fresnelDielectric(-ray.direction.y, 1.5f);
        EXPECT_NEAR(view.lamps.along(ray, sampler, rays).r, expected, 1e-4f * expected);
    }
}

// Whatever is followed, chosen or ended, all that a lossless ball lets through adds to 1.
TEST(SeenLamps, GlassBallInAShiningRoomIsInvisible) {
    SceneMaker maker;
    maker.box(Vec3d(-3), Vec3d(3), maker.diffuse({}, Rgb(1.0f)), true);
    maker.sphere({0, 0, 0}, 1.0, maker.material(glass()));
    maker.sphere({0.2, 0.1, 0}, 0.4, maker.material(glass(1.2f)));
    maker.camera({0, 0, 2.8}, {0, 0, 0}, {0, 1, 0}, 30);
    const Mean m = meanAlong(View(maker), 20'000);
    EXPECT_NEAR(m.mean, 1.0, 4 * m.standardError + 1e-5);
    EXPECT_LT(m.standardError, 0.002);
}

// Mirrors that shine, Le / (1 - rho): the paths would go on for ever, and end by roulette.
TEST(SeenLamps, ShiningMirrorsAllAround) {
    SceneMaker maker;
    MaterialDescription shining = mirror(0.8f);
    shining.emission = Rgb(1.0f);
    maker.box(Vec3d(-1), Vec3d(1), maker.material(shining), true);
    maker.camera({0.1, 0.2, 0.3}, {0.5, 0.1, -1}, {0, 1, 0}, 60);
    const Mean m = meanAlong(View(maker), 20'000);
    EXPECT_NEAR(m.mean, 5.0, 4 * m.standardError);
    EXPECT_LT(m.standardError, 0.04);
    EXPECT_LT(m.raysOfAPath, 12.0);
}

TEST(SeenLamps, PathsWhereLampsAreSeen) {
    SceneMaker maker = openRoom();
    maker.sphere({0, -0.5, 0}, 0.4, maker.material(mirror()));
    maker.quad({-0.9, 0.8, -0.9}, {0.3, 0, 0}, {0, 0, 0.3}, maker.diffuse({}, Rgb(5.0f)));
    maker.camera({0, 0, 3.9}, {0, 0, 0}, {0, 1, 0}, 37);
    const View view(maker);
    const auto paths = [&](std::int32_t x, std::int32_t y) { return view.lamps.shown(x, y).paths; };
    EXPECT_GT(paths(kSize * 5 / 16, kSize * 5 / 16), 0u) << "at the lamp";
    // The ball shows the lamp as far from its middle as the mirrored half-way direction says.
    const Vec3d half = normalize(normalize(Vec3d(-0.75, 1.3, -0.75)) + Vec3d(0, 0, 1));
    const double pixels = 0.4 * kSize / 2 / (3.9 * std::tan(18.5 * std::numbers::pi / 180));
    const double down = 0.5 / 0.4 * pixels;
    EXPECT_GT(paths(static_cast<std::int32_t>(kSize / 2 + pixels * half.x),
                    static_cast<std::int32_t>(kSize / 2 + down - pixels * half.y)),
              0u)
        << "at the lamp's image in the ball";
    EXPECT_EQ(paths(kSize / 2 - 1, kSize * 25 / 32), 0u) << "low in the ball";
    EXPECT_EQ(paths(kSize - 10, kSize / 2), 0u);
    EXPECT_EQ(paths(-1, 0), 0u);
    EXPECT_EQ(paths(0, kSize), 0u);
    SceneMaker dark = openRoom();
    dark.sphere({0, 0, 0}, 0.4, dark.material(mirror()));
    dark.camera({0, 0, 3.9}, {0, 0, 0}, {0, 1, 0}, 37);
    EXPECT_EQ(View(dark).lamps.shown(kSize / 2, kSize / 2).paths, 0u);
}

// A lamp seen straight, in a mirror and in glass, is found once: by the camera's path or by paths
// of its own.
TEST(SeenLamps, CountOnceInThePicture) {
    SceneMaker maker = openRoom();
    ceilingLamp(maker, 0.3, Rgb(10.0f));
    maker.sphere({-0.5, -0.5, 0}, 0.4, maker.material(mirror()));
    maker.sphere({0.5, -0.5, 0.3}, 0.4, maker.material(glass()));
    maker.camera({0, 0, 3.9}, {0, 0, 0}, {0, 1, 0}, 37);
    const auto scene = maker.build();
    const auto emission = [&](IntegratorKind kind, Rect region) {
        RenderSettings settings = smallFrame(32, 32, kind, 16, 3);
        settings.photons = 500;
        return measure(scene, settings, region).emission;
    };
    constexpr Rect kSpheres{0, 16, 32, 32};
    for (const Rect region : {Rect{}, kSpheres})
        EXPECT_TRUE(agree(emission(IntegratorKind::kPhoton, region),
                          emission(IntegratorKind::kPath, region), 0));
    const Measured seen = emission(IntegratorKind::kPhoton, kSpheres);
    EXPECT_GT(seen.mean[0], 20 * seen.standardError[0]);
}

}  // namespace
}  // namespace pm::test
