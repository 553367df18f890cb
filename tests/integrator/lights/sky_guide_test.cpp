// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Environments that are mostly hidden: where a window is, learnt.
#include "integrator/light_sampling/sky_guide.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "integrator/light_sampling/light_sampler.h"
#include "tests/support/scene_maker.h"
#include "tests/support/sky_picture.h"
#include "tests/support/statistics.h"
#include "tests/support/window_room.h"

namespace pm::test {
namespace {

constexpr double kSignificance = 0.01 / 20;  // 1 % for the whole file
constexpr double kPiD = std::numbers::pi;

TEST(SphereCells, AreOfEqualSolidAngle) {
    using Cells = SphereCells<16>;
    Random random(1);
    std::array<int, Cells::kCount> counts{};
    constexpr int kDirections = 256'000;
    for (int i = 0; i < kDirections; ++i)
        ++counts[Cells::cellOf(sampleUniformSphere(random.next2D()))];
    double statistic = 0;
    for (const int count : counts) statistic += (count - 1000.0) * (count - 1000.0) / 1000.0;
    EXPECT_GT(chiSquaredPValue(statistic, Cells::kCount - 1), kSignificance);
}

// Also over the folded edges.
TEST(SphereCells, CellsBesideEachOtherTouch) {
    using Cells = SphereCells<16>;
    constexpr Vec2f kMiddle{0.5f, 0.5f};
    const auto side = static_cast<std::int32_t>(Cells::kSide);
    for (std::int32_t row = 0; row < side; ++row)
        for (std::int32_t column = -1; column <= side; ++column) {
            const std::int32_t inside = std::clamp(column, 0, side - 1);
            const Vec3f a = Cells::directionIn(Cells::cellAt(inside, row), kMiddle);
            const Vec3f b = Cells::directionIn(Cells::cellAt(column, row), kMiddle);
            const Vec3f c = Cells::directionIn(Cells::cellAt(row, inside), kMiddle);
            const Vec3f d = Cells::directionIn(Cells::cellAt(row, column), kMiddle);
            // A cell is as wide as a square of its solid angle, 0.22, or twice that along a side.
            EXPECT_LT(length(a - b), 0.45f) << column << " " << row;
            EXPECT_LT(length(c - d), 0.45f) << column << " " << row;
        }
}

TEST(SphereCells, DirectionsLieInTheirCellEvenly) {
    using Cells = SphereCells<4>;
    Random random(2);
    int elsewhere = 0;
    DirectionTest test;
    test.samples = 100'000;
    const auto sample = [&]() -> std::optional<Vec3f> {
        const auto cell = static_cast<std::uint32_t>(random.next() * Cells::kCount);
        const Vec3f d = Cells::directionIn(cell, random.next2D());
        EXPECT_NEAR(length(d), 1, 1e-6);
        // At edges rounding tells one side from the other.
        elsewhere += Cells::cellOf(d) != cell;
        return d;
    };
    EXPECT_GT(test.pValue(sample, [](const Vec3f&) { return 1 / (4 * kPiD); }), kSignificance);
    EXPECT_LT(elsewhere, 20);
}

// Places along x; the sky is seen in a cone whose direction turns with x.
struct TurningWindow {
    std::vector<Receiver> places;

    TurningWindow() {
        for (int i = 0; i < 64; ++i)
            places.push_back({{0.1f * static_cast<float>(i), 0, 0}, {0, 1, 0}});
    }
    static Vec3f axisAt(float x) { return normalize(Vec3f{x - 3.0f, 2.0f, 0.5f}); }
    bool isSeen(std::size_t place, const Vec3f& d) const {
        return dot(d, axisAt(places[place].position.x)) > 0.9f;
    }
};

TEST(SkyGuide, SamplesItsDensity) {
    const auto sunny = sunnySky();
    const TurningWindow window;
    for (const SkyPicture* picture : {static_cast<const SkyPicture*>(nullptr), sunny.get()}) {
        const Environment environment({Rgb(1.0f), picture ? 0 : kNoTexture, kIdentityTransform},
                                      picture);
        const SkyGuide guide(environment, window.places, 3, [&](std::size_t place, const Vec3f& d) {
            return window.isSeen(place, d) ? environment.radiance(d).g : 0.0f;
        });
        for (const float x : {0.5f, 5.0f, 100.0f}) {
            const Vec3f position{x, 0, 0};
            Random random(4);
            const auto sample = [&]() -> std::optional<Vec3f> {
                float pdf;
                const Vec3f d = guide.sample(position, random.next2D(), pdf);
                EXPECT_GT(pdf, 0.0f);
                EXPECT_NEAR(guide.pdfSolidAngle(position, d) / pdf, 1,
                            x > 50 && picture ? 2.0 : 1e-4);
                return d;
            };
            DirectionTest test;
            test.samples = 100'000;
            const auto density = [&](float at) {
                return [&, at](const Vec3f& d) {
                    return static_cast<double>(guide.pdfSolidAngle({at, 0, 0}, d));
                };
            };
            EXPECT_GT(test.pValue(sample, density(x)), kSignificance) << x;
            // Twin: what was learnt elsewhere.
            EXPECT_LT(test.pValue(sample, density(3.0f)), kSignificance) << x;
            // Far from all places the environment is on its own.
            const Vec3f d = normalize(Vec3f{0.3f, 0.5f, -0.2f});
            if (x > 50) {
                EXPECT_EQ(guide.pdfSolidAngle(position, d), environment.pdfSolidAngle(d));
            }
        }
    }
}

// A black room over a floor that is looked at.
SceneMaker blackRoom(double half) {
    SceneMaker maker = windowRoom(half, Rgb(0.5f), {});
    maker.sky(Rgb(4.0f));
    maker.camera({0, 0, 0}, {0, -1, 0}, {0, 0, -1}, 60);
    return maker;
}

// Of the sky's radiance times pi, the share that arrives at a point of the floor through the
// window: four rectangles with a corner above it. Source: the configuration factor of a
// differential element to a parallel rectangle.
double shareThroughWindow(double half, double x, double z) {
    const auto corner = [](double a, double b) {
        const double p = std::sqrt(1 + a * a), q = std::sqrt(1 + b * b);
        return (a / p * std::atan(b / p) + b / q * std::atan(a / q)) / (2 * kPiD);
    };
    const auto signedCorner = [&](double a, double b) {
        return std::copysign(corner(std::abs(a), std::abs(b)), a * b);
    };
    double share = 0;
    for (const int i : {-1, 1})
        for (const int j : {-1, 1})
            share += i * j * signedCorner((i * half - x) / 2, (j * half - z) / 2);
    return share;
}

// Irradiance at points of the floor over the sky's radiance times pi; the squares' mean besides.
Moments irradiance(const Scene& scene, const LightSampler& lights, double x, double z) {
    Surface surface;
    surface.position = {static_cast<float>(x), -1, static_cast<float>(z)};
    surface.geometricNormal = surface.shadingNormal = {0, 1, 0};
    surface.offset = 1e-5f;
    Random random(5);
    return momentsOf(200'000, [&](std::uint32_t) {
        LightSample s;
        if (!lights.sample(surface, random.next2D(), s) || s.direction.y <= 0 ||
            scene.occluded(s.shadowRay))
            return 0.0;
        return static_cast<double>(s.radiance.r * s.direction.y / s.pdfSolidAngle) / (4 * kPiD);
    });
}

TEST(SkyGuide, LightThroughAWindow) {
    for (const double half : {0.25, 0.06}) {
        const auto scene = blackRoom(half).build();
        LightSampler lights(*scene);
        const LightSampler untaught(*scene);
        std::vector<LitPlace> places;
        Random random(6);
        for (int i = 0; i < 1000; ++i) {
            LitPlace place;
            place.surface.position = {2 * random.next() - 1, -1, 2 * random.next() - 1};
            place.surface.geometricNormal = place.surface.shadingNormal = place.side = {0, 1, 0};
            place.surface.offset = 1e-5f;
            places.push_back(place);
        }
        lights.learn(places, 7);
        EXPECT_GT(lights.memoryBytes(), untaught.memoryBytes());
        for (const auto& [x, z] :
             {std::pair{0.0, 0.0}, std::pair{0.7, -0.5}, std::pair{-0.95, 0.95}}) {
            const double expected = shareThroughWindow(half, x, z);
            const Moments with = irradiance(*scene, lights, x, z);
            const Moments without = irradiance(*scene, untaught, x, z);
            EXPECT_NEAR(with.mean, expected, 4 * with.standardError) << half << " " << x;
            EXPECT_NEAR(without.mean, expected, 4 * without.standardError) << half << " " << x;
            fmt::print("    window {}, at {}: variance over that of the sky's own choice {:.4f}\n",
                       half, x, with.variance / without.variance);
            EXPECT_LT(with.variance, 0.2 * without.variance) << half << " " << x;
        }
    }
}

// In the open there is nothing to learn.
TEST(SkyGuide, OpenSkyIsChosenAsItIs) {
    SceneMaker maker;
    maker.quad({-1, 0, 1}, {2, 0, 0}, {0, 0, -2}, maker.diffuse(Rgb(0.5f)));
    maker.sky(Rgb(1.0f));
    const auto scene = maker.build();
    LightSampler lights(*scene);
    EXPECT_TRUE(lights.learns());
    std::vector<LitPlace> places(100);
    for (LitPlace& place : places) {
        place.surface.geometricNormal = place.surface.shadingNormal = place.side = {0, 1, 0};
        place.surface.offset = 1e-5f;
    }
    lights.learn(places, 1);
    EXPECT_EQ(lights.memoryBytes(), 0u);
}

// Rendered, the floor is as bright as the window makes it, by photons and by paths; the camera is
// far enough above the floor that all of it counts.
TEST(SkyGuide, FloorUnderAWindow) {
    constexpr double kHalf = 0.2;
    const auto scene = blackRoom(kHalf).build();
    // The camera sees 2 tan 30 degrees of the floor, both ways.
    const double side = std::tan(kPiD / 6);
    double expected = 0;
    constexpr int kSteps = 64;
    for (int i = 0; i < kSteps; ++i)
        for (int j = 0; j < kSteps; ++j)
            expected += shareThroughWindow(kHalf, side * (2 * (i + 0.5) / kSteps - 1),
                                           side * (2 * (j + 0.5) / kSteps - 1)) /
                        (kSteps * kSteps);
    for (const IntegratorKind kind : {IntegratorKind::kPath, IntegratorKind::kPhoton}) {
        const Measured m = measure(scene, smallFrame(32, 32, kind, 16, 3)).beauty;
        EXPECT_TRUE(agrees(m, Rgb(static_cast<float>(0.5 * 4 * expected)), 1e-3));
        EXPECT_LT(m.standardError[0], 0.02 * m.mean[0]);
    }
}

}  // namespace
}  // namespace pm::test
