// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Images of lamps much smaller than a pixel, straight and in a mirror: where they are, how large,
// and that pixels show them with little noise.
#include "integrator/transport/seen_lights/lamp_images.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "integrator/sampling/pixel_filter.h"
#include "integrator/transport/seen_lights/seen_lamps.h"
#include "tests/support/replicates.h"
#include "tests/support/rooms.h"
#include "tests/support/scene_maker.h"

namespace pm::test {
namespace {

constexpr std::int32_t kSize = 32;
constexpr double kFov = 40, kRadius = 0.002;
constexpr float kShine = 5e4f, kReflected = 0.8f;
constexpr double kLampX = 0.35, kLampY = 0.13, kLampZ = -2, kMirrorZ = -3;

// A camera in the origin, a lamp of a hundredth of a pixel, and a mirror behind it.
SceneMaker lampAndMirror() {
    SceneMaker maker;
    maker.quad({-2, -2, kMirrorZ}, {4, 0, 0}, {0, 4, 0}, maker.material(mirror(kReflected)));
    maker.sphere({kLampX, kLampY, kLampZ}, kRadius, maker.diffuse({}, Rgb(kShine)));
    maker.camera({0, 0, 0}, {0, 0, -1}, {0, 1, 0}, kFov);
    return maker;
}

// An image as a small sphere at a distance along z shows it.
struct Shown {
    double x, y;  // pixels
    double area;  // pixels squared
};
Shown shownAt(double distance) {
    const double pixel = 2 * std::tan(kFov / 2 * std::numbers::pi / 180) / kSize;
    const double x = kLampX / distance, y = kLampY / distance, squared = 1 + x * x + y * y;
    // The sphere's solid angle over a pixel's.
    const double solidAngle =
        std::numbers::pi * kRadius * kRadius / (distance * distance * squared);
    return {kSize / 2.0 + x / pixel, kSize / 2.0 - y / pixel,
            solidAngle / (pixel * pixel / (squared * std::sqrt(squared)))};
}
const Shown kStraight = shownAt(-kLampZ), kMirrored = shownAt(kLampZ - 2 * kMirrorZ);

TEST(LampImages, AreFoundWhereTheyAre) {
    const auto scene = lampAndMirror().build();
    const Camera camera(*scene, kSize, kSize);
    const LightSampler lights(*scene);
    const SeenLamps lamps(*scene, lights, camera,
                          {.width = kSize, .height = kSize, .errorScale = {}});
    for (const auto& [shown, radiance] :
         {std::pair{kStraight, kShine}, std::pair{kMirrored, kReflected * kShine}}) {
        int found = 0;
        for (const LampImage& image :
             lamps.shown(static_cast<int>(shown.x), static_cast<int>(shown.y)).images) {
            if (std::hypot(image.centre[0] - shown.x, image.centre[1] - shown.y) > 0.02) continue;
            ++found;
            // The rectangle around an ellipse.
            EXPECT_NEAR(shown.area / image.area(), std::numbers::pi / 4 / (1.3 * 1.3), 0.02);
            Sampler sampler(1, 0, 0, 0);
            std::uint32_t rays = 0;
            const Rgb seen =
                lamps.along(camera.ray({image.centre[0], image.centre[1]}), sampler, rays);
            EXPECT_NEAR(static_cast<double>(seen.g), radiance, 1e-3 * radiance);
        }
        EXPECT_EQ(found, 1);
    }
}

// Of more lamps than are tried everywhere, those of a square.
TEST(LampImages, OfHundredsOfLampsAreFound) {
    SceneMaker maker;
    const std::uint32_t shine = maker.diffuse({}, Rgb(kShine));
    std::vector<std::array<double, 2>> places;
    const double pixel = 2 * std::tan(kFov / 2 * std::numbers::pi / 180) / kSize;
    for (int i = 0; i < 200; ++i) {
        const double x = (i % 20 - 9.5) * 0.068 + 0.01 * (i % 3), y = (i / 20 - 4.5) * 0.13;
        maker.sphere({x, y, kLampZ}, kRadius, shine);
        places.push_back({kSize / 2.0 - x / kLampZ / pixel, kSize / 2.0 + y / kLampZ / pixel});
    }
    maker.camera({0, 0, 0}, {0, 0, -1}, {0, 1, 0}, kFov);
    const auto scene = maker.build();
    const Camera camera(*scene, kSize, kSize);
    const LightSampler lights(*scene);
    const SeenLamps lamps(*scene, lights, camera,
                          {.width = kSize, .height = kSize, .errorScale = {}});
    std::size_t found = 0;
    for (const std::array<double, 2>& at : places) {
        const auto square = lamps.shown(static_cast<int>(at[0]), static_cast<int>(at[1]));
        found += std::ranges::any_of(square.images, [&](const LampImage& image) {
            return std::hypot(image.centre[0] - at[0], image.centre[1] - at[1]) < 0.02;
        });
    }
    EXPECT_EQ(found, places.size());
}

// A glass ball shows a small lamp many times, some by way of the same lobes: nearly all places of a
// fine lattice that show it are in the images of their squares.
TEST(LampImages, AreFoundInGlass) {
    SceneMaker maker;
    maker.sphere({0, 0, -3}, 1.0, maker.material(glass()));
    for (const Vec3d& place : {Vec3d(-0.5, 0.7, -6), Vec3d(2, 1, -3.5), Vec3d(-1, -1.5, -1)})
        maker.sphere(place, 0.03, maker.diffuse({}, Rgb(kShine)));
    maker.camera({0, 0, 0}, {0, 0, -1}, {0, 1, 0}, kFov);
    const auto scene = maker.build();
    const Camera camera(*scene, kSize, kSize);
    const LightSampler lights(*scene);
    const SeenLamps lamps(*scene, lights, camera,
                          {.width = kSize, .height = kSize, .errorScale = {}});
    constexpr int kFine = 16;  // places along a pixel
    std::vector<LampRay> rays;
    int shown = 0, found = 0;
    for (int y = 0; y < kSize * kFine; ++y)
        for (int x = 0; x < kSize * kFine; ++x) {
            const double atX = (x + 0.5) / kFine, atY = (y + 0.5) / kFine;
            rays.clear();
            if (isBlack(followLobes(*scene, lights, camera, atX, atY, rays))) continue;
            ++shown;
            const SeenLamps::Shown square = lamps.shown(x / kFine, y / kFine);
            found += std::ranges::any_of(
                square.images, [&](const LampImage& image) { return image.holds(atX, atY); });
        }
    fmt::print("    {} of {} places\n", found, shown);
    EXPECT_GT(shown, 100);
    EXPECT_GT(found, 0.97 * shown);
}

// By box and by Gaussian filter: over the pixels around, all that the image sends, and in each
// render little noise. Without paths towards it 16 samples would find a hundredth of a pixel once
// in six renders.
TEST(LampImages, PixelsShowThemWithLittleNoise) {
    const auto scene = lampAndMirror().build();
    std::vector<Rect> regions;
    for (const Shown& shown : {kStraight, kMirrored}) {
        const auto x = static_cast<std::int32_t>(shown.x), y = static_cast<std::int32_t>(shown.y);
        regions.push_back({x - 1, y - 1, x + 2, y + 2});
    }
    for (const PixelFilter filter : {PixelFilter::kBox, PixelFilter::kGaussian}) {
        const auto renders = replicate(16, [&](std::uint64_t seed) {
            RenderSettings settings = smallFrame(kSize, kSize, IntegratorKind::kPhoton, 2, 3);
            settings.seed = seed;
            settings.filter = filter;
            return render(scene, settings, regions);
        });
        for (const auto& [shown, radiance, r] :
             {std::tuple{kStraight, kShine, 0u}, std::tuple{kMirrored, kReflected * kShine, 1u}}) {
            // What the pixels around count it for by their filters, together: not quite 1.
            const auto counted = [&](double at) {
                double sum = 0;
                for (int pixel = -1; pixel <= 1; ++pixel)
                    sum += densityInPixel(filter, at - std::floor(at) - pixel);
                return sum;
            };
            const double expected = radiance * shown.area / 9 * counted(shown.x) * counted(shown.y);
            const Replicated emission = spread(renders, r, kEmission, 1);
            fmt::print("    {:.4f} of what is expected +- {:.4f}\n", emission.mean / expected,
                       emission.standardError / expected);
            EXPECT_LT(zScore(emission, {expected, 0, 1000}, 0), 4);
            EXPECT_LT(emission.standardError, 0.03 * expected);
        }
    }
}

// Densities of places, by their own distribution: the share below each of ten places.
TEST(LampImages, DensityOfAFilterIsThatOfItsPlaces) {
    for (const PixelFilter filter : {PixelFilter::kBox, PixelFilter::kGaussian}) {
        constexpr int kSteps = 20'000;
        double area = 0, u = 0;
        for (int i = 0; i < kSteps; ++i) {
            const double at = -1 + 3 * (i + 0.5) / kSteps;
            area += densityInPixel(filter, at) * 3 / kSteps;
            while (u < 1 && placeInPixel(filter, static_cast<float>(u)) <= at) u += 1e-3;
            EXPECT_NEAR(area, std::min(u, 1.0), 2.5e-3) << at;
        }
        EXPECT_NEAR(area, 1, 1e-3);
        EXPECT_EQ(densityInPixel(filter, 2.1), 0);
    }
}

}  // namespace
}  // namespace pm::test
