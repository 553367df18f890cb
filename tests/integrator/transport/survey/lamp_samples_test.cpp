// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Several lamp samples a camera sample: the same mean, less noise, and how many a pilot finds to
// pay.
#include "integrator/transport/survey/lamp_samples.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <array>
#include <atomic>
#include <cmath>
#include <memory>
#include <vector>

#include "integrator/transport/photon/photon_integrator.h"
#include "tests/support/rooms.h"
#include "tests/support/scene_maker.h"
#include "tests/support/statistics.h"

namespace pm::test {
namespace {

constexpr double kPiD = 3.14159265358979323846;
constexpr std::array<std::uint32_t, 4> kNumbers = {1, 4, 8, 16};

// Light by way of a camera ray from `eye` to `at`, world, without maps: direct light and what a
// glossy lobe brings, by next-event estimation and by sampling the lobes.
Moments lightAlong(const Scene& scene, Vec3d eye, Vec3d at, std::uint32_t lampSamples) {
    constexpr std::uint32_t kCount = 20'000;
    const LightSampler lights(scene);
    const PhotonIntegrator integrator(scene, lights, {}, lampSamples);
    const Ray ray{Vec3f(eye - scene.centre()), Vec3f(normalize(at - eye))};
    NearestPhotons scratch;
    return momentsOf(kCount, [&](std::uint32_t i) {
        // Each by a sequence of its own: independent, for the standard error.
        Sampler sampler(5, 0, i, 0);
        return static_cast<double>(integrator.sample({{}, ray}, sampler, scratch).direct.g);
    });
}

// A large lamp close above a floor: rays along the lobe find much of its light.
SceneMaker lampCloseToFloor(const MaterialDescription& floor) {
    SceneMaker maker;
    maker.quad({-4, 0, 4}, {8, 0, 0}, {0, 0, -8}, maker.material(floor));
    maker.quad({-1, 0.5, -1}, {2, 0, 0}, {0, 0, 2}, maker.diffuse({}, Rgb(3.0f)));
    return maker;
}

MaterialDescription grey() {
    MaterialDescription m;
    m.diffuse = Rgb(0.5f);
    return m;
}

// Of that lamp at (x, 0, z): integral of cos cos / d^2 over it.
double irradianceAt(double x, double z) {
    constexpr int kSteps = 400;
    constexpr double kHeight = 0.5, kStep = 2.0 / kSteps;
    double sum = 0;
    for (int i = 0; i < kSteps; ++i)
        for (int j = 0; j < kSteps; ++j) {
            const double dx = -1 + kStep * (i + 0.5) - x, dz = -1 + kStep * (j + 0.5) - z;
            const double d2 = dx * dx + dz * dz + kHeight * kHeight;
            sum += kHeight * kHeight / (d2 * d2) * kStep * kStep;
        }
    return 3 * sum;
}

// A room with a dozen small lamps and pillars: from each place some are hidden.
SceneMaker roomOfLamps() {
    SceneMaker maker;
    const auto white = maker.diffuse(Rgb(0.6f));
    maker.box({-2, 0, -2}, {2, 2.5, 2}, white, true);
    for (int i = 0; i < 9; ++i) {
        const double x = -1.5 + 1.2 * (i % 3), z = -1.5 + 1.2 * (i / 3);
        maker.box({x, 0, z}, {x + 0.25, 2, z + 0.25}, white, false);
    }
    for (int i = 0; i < 12; ++i) {
        const Rgb radiance = Rgb(static_cast<float>(10 + 15 * (i % 4)));
        maker.quad({-1.8 + 0.3 * i, 2.45, 1.5 * std::sin(2.0 * i)}, {0.1, 0, 0}, {0, 0, 0.1},
                   maker.diffuse({}, radiance));
    }
    maker.camera({1.9, 2.2, 1.9}, {-0.4, 0.4, -0.4}, {0, 1, 0}, 60);
    return maker;
}

// A floor and a wall under a small lamp far above: even light, no shadow.
SceneMaker evenlyLit() {
    SceneMaker maker;
    const auto white = maker.diffuse(Rgb(0.6f));
    maker.quad({-2, 0, 2}, {4, 0, 0}, {0, 0, -4}, white);
    maker.quad({-2, 0, -2}, {4, 0, 0}, {0, 2, 0}, white);
    maker.quad({-0.1, 8, 3}, {0.2, 0, 0}, {0, 0, 0.2}, maker.diffuse({}, Rgb(900.0f)));
    maker.camera({0, 2, 4}, {0, 0.4, 0}, {0, 1, 0}, 35);
    return maker;
}

RenderSettings frame() {
    return smallFrame(48, 48, IntegratorKind::kPhoton, 4, 3);
}

std::uint32_t found(const std::shared_ptr<const Scene>& scene, const RenderSettings& settings) {
    FrameRenderer renderer(scene, settings);
    renderer.prepare(std::atomic<bool>(false));
    return renderer.plan().lampSamples;
}

std::uint32_t found(const SceneMaker& maker, const RenderSettings& settings) {
    return found(maker.build(), settings);
}

// Points of all parts of all samples are one sequence.
TEST(LampSamples, PartsOfASampleAreOneSequence) {
    for (const std::uint32_t count : {1u, 4u, 16u})
        for (std::uint32_t index = 0; index < 8; ++index) {
            const Sampler parted(3, 1, 7, index);
            for (std::uint32_t i = 0; i < count; ++i) {
                const Vec2f expected = Sampler(3, 1, 7, index * count + i).get2D(Purpose::kDirect);
                const Vec2f u = parted.part(count, i).get2D(Purpose::kDirect);
                EXPECT_EQ(u.x, expected.x);
                EXPECT_EQ(u.y, expected.y);
            }
        }
}

// Lamps and the lobe both find the light, weighted: whatever the number, it adds up.
TEST(LampSamples, LargeLampNearAFloor) {
    const auto scene = lampCloseToFloor(grey()).build();
    for (const double x : {0.0, 1.4}) {
        const double expected = 0.5 / kPiD * irradianceAt(x, 0.2);
        for (const std::uint32_t n : kNumbers) {
            const Moments m = lightAlong(*scene, {3, 0.4, 0.2}, {x, 0, 0.2}, n);
            EXPECT_NEAR(m.mean, expected, 4 * m.standardError + 1e-5) << n;
            EXPECT_LT(m.standardError, 0.01 * expected);
        }
    }
}

// An even sky over a floor, found by both strategies: all that the floor reflects.
TEST(LampSamples, EvenSky) {
    SceneMaker maker;
    maker.quad({-4, 0, 4}, {8, 0, 0}, {0, 0, -8}, maker.material(grey()));
    maker.sky(Rgb(2.0f));
    const auto scene = maker.build();
    for (const std::uint32_t n : kNumbers) {
        const Moments m = lightAlong(*scene, {0, 2, 1}, {0, 0, 0}, n);
        EXPECT_NEAR(m.mean, 1.0, 4 * m.standardError + 1e-5) << n;
    }
}

// A glossy lobe goes on to the lamp with the weight that the samples before left it.
TEST(LampSamples, GlossyFloorUnderALamp) {
    MaterialDescription floor = grey();
    floor.diffuse = Rgb(0.2f);
    floor.glossy = Rgb(0.6f);
    floor.glossyExponent = 30;
    const auto scene = lampCloseToFloor(floor).build();
    const Moments one = lightAlong(*scene, {2, 0.6, 0.2}, {0.9, 0, 0.2}, 1);
    for (const std::uint32_t n : kNumbers) {
        const Moments m = lightAlong(*scene, {2, 0.6, 0.2}, {0.9, 0, 0.2}, n);
        EXPECT_NEAR(m.mean, one.mean, 4 * std::hypot(m.standardError, one.standardError)) << n;
        EXPECT_LT(m.standardError, 0.02 * one.mean);
    }
}

// At least as 1/n: they are spread evenly.
TEST(LampSamples, VarianceFalls) {
    const auto scene = roomOfLamps().build();
    const auto at = [&](std::uint32_t n) {
        return lightAlong(*scene, {1.9, 2.2, 1.9}, {0.9, 0, 1.0}, n);
    };
    const Moments one = at(1);
    for (const std::uint32_t n : kNumbers) {
        const Moments m = at(n);
        EXPECT_NEAR(m.mean, one.mean, 4 * std::hypot(m.standardError, one.standardError)) << n;
        EXPECT_LT(m.variance, 1.1 * one.variance / n) << n;
        fmt::print(
            "    {:2} lamp samples: {:.4f} +- {:.4f}, variance x n over that of one {:.2f}\n", n,
            m.mean, m.standardError, m.variance * n / one.variance);
    }
}

// A whole picture, maps and all: the number is obeyed, and the mean stays.
TEST(LampSamples, PicturesHaveTheSameMean) {
    constexpr std::size_t kPixels = 48 * 48;
    const auto scene = roomOfLamps().build();
    const auto rendered = [&](std::uint32_t n, std::uint64_t& rays) {
        RenderSettings settings = frame();
        settings.photons = 2000;
        Plan plan = makePlan(*scene, settings);
        plan.lampSamples = n;
        FrameRenderer renderer(scene, settings, plan);
        const ChannelLayout layout = renderer.layout();
        std::vector<float> pixels(kPixels * static_cast<std::size_t>(layout.count));
        std::vector<float> weights(kPixels);
        const std::atomic<bool> cancelled{false};
        renderer.beginPass(0, cancelled, {});
        renderer.renderRegion(settings.window, pixels, weights, cancelled);
        rays = renderer.counters().rays;
        double sum = 0;
        for (std::size_t i = 0; i < kPixels; ++i)
            sum += static_cast<double>(pixels[i * static_cast<std::size_t>(layout.count) +
                                              static_cast<std::size_t>(layout.direct) + 1]);
        return sum / kPixels;
    };
    std::uint64_t fewRays = 0, manyRays = 0;
    const double one = rendered(1, fewRays), eight = rendered(8, manyRays);
    // 4 samples a pixel, of a relative spread below 1: a standard error below 1 %.
    EXPECT_NEAR(eight, one, 0.04 * one);
    EXPECT_GT(manyRays, fewRays + 4 * 4 * kPixels);
}

TEST(LampSamples, ManyWhereLampsAreNoisyOneWhereTheyAreNot) {
    const std::uint32_t many = found(roomOfLamps(), frame()), one = found(evenlyLit(), frame());
    fmt::print("    a room of lamps and pillars: {}; even light: {}\n", many, one);
    EXPECT_GE(many, 4u);
    EXPECT_LE(many, kMostLampSamples);
    EXPECT_EQ(one, 1u);
    SceneMaker dark = openRoom();
    EXPECT_EQ(found(dark, frame()), 1u);
    SceneMaker point = openRoom();
    point.pointLight({0, 0.5, 0}, Rgb(1.0f));
    EXPECT_EQ(found(point, frame()), 1u);
    RenderSettings path = frame();
    path.integrator = IntegratorKind::kPath;
    EXPECT_EQ(found(roomOfLamps(), path), 1u);
}

// The dearer the rest of a sample, the more lamp samples: photons for few samples, or for many.
TEST(LampSamples, MoreWhereTheRestIsDear) {
    RenderSettings cheap = frame(), dear = frame();
    cheap.photons = 100;
    cheap.gatherRays = 1;
    cheap.aaLevel = 6;
    dear.photons = 1'000'000;
    EXPECT_LT(found(roomOfLamps(), cheap), found(roomOfLamps(), dear));
}

// What may differ between the parts of one picture does not enter.
TEST(LampSamples, NotByCropPassesOrThreads) {
    const auto scene = roomOfLamps().build();
    const auto number = [&](const RenderSettings& settings, int threads) {
        std::uint32_t n = 0;
        tbb::task_arena(threads).execute([&] { n = found(scene, settings); });
        return n;
    };
    RenderSettings other = frame();
    other.window = {8, 8, 16, 24};
    other.passes = 1;
    EXPECT_EQ(number(frame(), 1), number(other, 2));
}

}  // namespace
}  // namespace pm::test
