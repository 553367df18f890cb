// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Many lights: light against sums over all lamps, and ten thousand lamps against ten.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <atomic>
#include <cmath>
#include <ctime>

#include "integrator/light_sampling/light_guide.h"
#include "integrator/light_sampling/light_sampler.h"
#include "integrator/light_sampling/light_tree.h"
#include "integrator/transport/survey/lit_places.h"
#include "tests/integrator/lights/lamp_rooms.h"
#include "tests/support/statistics.h"

namespace pm::test {
namespace {

// Irradiance of the surface by all lamps, a lamp as small as these being a point that shines by
// the cosine.
double irradiance(const Scene& scene, const Surface& at) {
    double sum = 0;
    for (const Light& light : scene.lights()) {
        const Surface on = scene.pointOnLight(light, {5.0f / 9.0f, 0.5f});  // the centroid
        const Vec3f to = on.position - at.position;
        const float d2 = lengthSquared(to), d = std::sqrt(d2);
        const float in = dot(to, at.shadingNormal) / d, out = -dot(to, on.geometricNormal) / d;
        if (!(in > 0.0f) || !(out > 0.0f)) continue;
        const Vec3f origin = rayOrigin(at, to);
        const Vec3f end = on.position + on.geometricNormal * (2.0f * on.offset + 1e-5f);
        if (scene.occluded({origin, end - origin, 1.0f})) continue;
        const float radiance = scene.material(light.surface()->material).emission.g;
        sum += static_cast<double>(radiance * light.surface()->area * in * out / d2);
    }
    return sum;
}

// The same by sampling; its standard error is `error`, its standard deviation over its mean
// `spread`.
double sampledIrradiance(const Room& room, const Surface& at, int samples, double& error,
                         double& spread) {
    Random random(11);
    double sum = 0, squares = 0;
    for (int i = 0; i < samples; ++i) {
        LightSample light;
        if (!room.lights->sample(at, at.geometricNormal, random.next2D(), light)) continue;
        const float cosine = dot(light.direction, at.shadingNormal);
        if (!(cosine > 0.0f) || room.scene->occluded(light.shadowRay)) continue;
        const auto value = static_cast<double>(light.radiance.g * cosine / light.pdfSolidAngle);
        sum += value;
        squares += value * value;
    }
    const double mean = sum / samples, variance = squares / samples - mean * mean;
    error = std::sqrt(variance / samples);
    spread = std::sqrt(variance) / mean;
    return mean;
}

// The density of a sample is the density that a ray to the same point finds, on either side of a
// surface.
TEST(ManyLights, DensitiesMatch) {
    Room room(30, 30);
    // Sheets between which the camera looks, seen from behind as often as from the front.
    SceneMaker maker = makeRoom(30, 30);
    const auto grey = maker.diffuse(Rgb(0.5f));
    for (int i = 0; i < 6; ++i)
        maker.quad({-1.5 + 0.5 * i, 0.3, 0.5}, {0.2, 0.5, 0}, {0, 0, i % 2 ? 0.7 : -0.7}, grey);
    room.scene = maker.build();
    room.lights = std::make_unique<LightSampler>(*room.scene);
    room.learn();
    Random random(4);
    int compared = 0, behind = 0, wrong = 0;
    for (const LitPlace& place : room.places()) {
        LightSample sample;
        if (!room.lights->sample(place.surface, place.side, random.next2D(), sample) ||
            !(dot(sample.direction, place.side) > 0.0f))
            continue;
        Surface on;
        if (!room.scene->intersect(rayFrom(place.surface, sample.direction), on) || on.light < 0)
            continue;
        const float pdf = room.lights->pdfSolidAngle(place.surface, sample.direction, on);
        ++compared;
        behind += dot(place.side, place.surface.geometricNormal) < 0.0f;
        // A ray to the seam of a lamp's two triangles may meet the other.
        wrong += std::abs(pdf / sample.pdfSolidAngle - 1.0f) > 5e-3f;
    }
    EXPECT_GT(compared, 200);
    EXPECT_GT(behind, compared / 100);
    EXPECT_LE(wrong, compared / 100);
}

// Sampled irradiance is that of all lamps: where it was learnt, and where it was not (the slab's
// top: what was learnt anywhere near says that those lamps are hidden).
TEST(ManyLights, IrradianceIsTheSumOverLamps) {
    Room room(40, 40);
    for (const bool learnt : {false, true}) {
        if (learnt) room.learn();
        for (const Surface& at : room.receivers()) {
            double error, spread;
            const double sampled = sampledIrradiance(room, at, 200'000, error, spread);
            const double expected = irradiance(*room.scene, at);
            // A lamp that is partly hidden is taken as hidden or not by its middle: 3 in 1000.
            EXPECT_NEAR(sampled, expected, 4 * error + 0.003 * expected) << learnt;
            EXPECT_LT(spread, 4);
            fmt::print("    {}: sampled {:.4f} +- {:.4f}, sum {:.4f}; spread of a sample {:.2f}\n",
                       learnt ? "learnt" : "tree only", sampled, error, expected, spread);
        }
    }
}

// A guide that was told wrong, that half the lamps are hidden from everywhere, still finds each of
// them often enough.
TEST(ManyLights, WhatWasNotSeenIsFoundAllTheSame) {
    const Room room(20, 20);
    LightTree tree(*room.scene);
    const auto count = static_cast<std::uint32_t>(room.scene->lights().size());
    std::vector<Receiver> receivers;
    for (int i = 0; i < 256; ++i)
        receivers.push_back(facing(room.seen({0.005 * i, 1, 1}, {0, -1, 0})));
    const LightGuide guide(
        tree, receivers, [&](std::size_t i, std::uint32_t node, std::uint32_t number) {
            LightDescent descent{0.25 * number, node};
            tree.choose(receivers[i], {&descent, 1});
            return Sighting{descent.node, 2 * tree.position(descent.node) < count};
        });
    double least = 1, hidden = 0;
    for (std::uint32_t light = 0; light < count; ++light) {
        const auto p = static_cast<double>(guide.probability(receivers[0], light));
        least = std::min(least, p / static_cast<double>(
                                        tree.probability(LightTree::kRoot, receivers[0], light)));
        if (2 * tree.position(light) >= count) hidden += p;
    }
    fmt::print("    hidden half: {:.3f} of the choices, a lamp at least {:.3f} of its own\n",
               hidden, least);
    EXPECT_GT(least, 0.2);
    EXPECT_LT(hidden, 0.3);
}

// Where all that is known says that lamps bring next to nothing, they are still chosen.
TEST(ManyLights, WeakLampsAreNotForgotten) {
    SceneMaker maker = makeRoom(10, 10);
    const auto weak = maker.diffuse({}, Rgb(1e-6f));
    for (int i = 0; i < 4; ++i)
        maker.quad({-1.9, 0.5 + 0.1 * i, 0}, {0, 0.05, 0}, {0, 0, 0.05}, weak);
    const auto scene = maker.build();
    const LightTree tree(*scene);
    const std::vector<Receiver> receivers = {{Vec3f(Vec3d{1, 0, 1} - scene->centre()), {0, 1, 0}}};
    const LightGuide guide(tree, receivers, [](std::size_t, std::uint32_t, std::uint32_t) {
        return std::optional<Sighting>();
    });
    double sum = 0;
    for (std::uint32_t light = 0; light < scene->lights().size(); ++light)
        if (scene->material(scene->lights()[light].surface()->material).emission.r < 1.0f)
            sum += static_cast<double>(guide.probability(receivers[0], light));
    EXPECT_GT(sum, 1e-4);
    EXPECT_LT(sum, 1e-2);
}

// Half of the lamps don't reach the floor: they are chosen seldom. Nearness counts, too.
TEST(ManyLights, HiddenLampsAreSeldomChosen) {
    Room room(40, 40);
    const Surface floor = room.seen({0.2, 1, 1}, {0, -1, 0});
    const auto visibleShare = [&] {
        Random random(5);
        int visible = 0;
        for (int i = 0; i < 20'000; ++i) {
            LightSample light;
            visible += room.lights->sample(floor, floor.geometricNormal, random.next2D(), light) &&
                       !room.scene->occluded(light.shadowRay);
        }
        return visible / 20'000.0;
    };
    const double before = visibleShare();
    room.learn();
    const double after = visibleShare();
    fmt::print("    share of samples that reach the floor: {:.3f}, learnt {:.3f}\n", before, after);
    EXPECT_LT(before, 0.65);
    EXPECT_GT(after, 0.85);
    EXPECT_LT(room.lights->memoryBytes(), 32u << 20);
}

// The same choices, however many threads learn.
TEST(ManyLights, LearningIsTheSameForAnyNumberOfThreads) {
    Room one(30, 30), two(30, 30);
    tbb::task_arena(1).execute([&] { one.learn(); });
    tbb::task_arena(2).execute([&] { two.learn(); });
    Random random(6);
    for (const Surface& at : one.receivers())
        for (int i = 0; i < 1000; ++i) {
            const Vec2f u = random.next2D();
            LightSample a, b;
            one.lights->sample(at, at.geometricNormal, u, a);
            two.lights->sample(at, at.geometricNormal, u, b);
            EXPECT_EQ(a.direction, b.direction);
            EXPECT_EQ(a.pdfSolidAngle, b.pdfSolidAngle);
        }
}

// Triangles, spheres and points, on both sides of a wall and around: light by photons, paths and
// in the limit.
TEST(ManyLights, MixedLampsAgree) {
    SceneMaker maker;
    const auto white = maker.diffuse(Rgb(0.6f));
    maker.box({-2, 0, -2}, {2, 3, 2}, white, true);
    maker.quad({-0.5, 0, -2}, {0, 0, 2.5}, {0, 2, 0}, white);  // a thin wall, both sides lit
    const auto lamp = maker.diffuse({}, {3, 2, 1});
    for (int i = 0; i < 24; ++i) {
        const double x = -1.8 + 0.15 * i, z = 1.5 * std::sin(1.7 * i);
        maker.quad({x, 2.8, z}, {0.1, 0, 0}, {0, 0, 0.1}, lamp);
        maker.sphere({x, 0.3 + 0.05 * (i % 5), -z}, 0.04, lamp);
        maker.pointLight({x, 1.5, 0.3 * z}, Rgb(0.02f));
    }
    maker.camera({1.8, 1.5, 1.8}, {-1, 1, -1}, {0, 1, 0}, 70);
    const auto scene = maker.build();
    RenderSettings settings = smallFrame(24, 24, IntegratorKind::kPhoton, 16, 4);
    const MeasuredLayers photon = measure(scene, settings);
    settings.integrator = IntegratorKind::kPath;
    const MeasuredLayers path = measure(scene, settings);
    EXPECT_TRUE(agree(photon.direct, path.direct, 0, 6));
    EXPECT_TRUE(agree(photon.indirect, path.indirect, 0.02, 6));
}

struct Cost {
    double relativeVariance = 0;  // of a pixel's beauty
    double seconds = 0;           // of one processor, for a render
    double direct = 0;            // mean
    double product() const { return relativeVariance * seconds; }
};

// Between independent seeds; the shortest of the renders' times.
Cost costOf(const Room& room) {
    constexpr int kSeeds = 5;
    const std::size_t size = static_cast<std::size_t>(room.settings.window.area());
    std::vector<double> sums(size), squares(size);
    Cost cost;
    cost.seconds = 1e9;
    for (int seed = 1; seed <= kSeeds; ++seed) {
        RenderSettings settings = room.settings;
        settings.seed = static_cast<std::uint64_t>(seed);
        const std::clock_t start = std::clock();
        FrameRenderer renderer(room.scene, settings);
        const auto layout = renderer.layout();
        const auto channels = static_cast<std::size_t>(layout.count);
        std::vector<double> picture(size);
        std::vector<float> pixels(size * channels), weights(size);
        const std::atomic<bool> cancelled{false};
        for (std::uint32_t pass = 0; pass < settings.passes; ++pass) {
            renderer.beginPass(pass, cancelled, {});
            renderer.renderRegion(settings.window, pixels, weights, cancelled);
            for (std::size_t i = 0; i < size; ++i) {
                const float* pixel = pixels.data() + i * channels;
                picture[i] += static_cast<double>(pixel[layout.beauty + 1]) / settings.passes;
                cost.direct += static_cast<double>(pixel[layout.direct + 1]) / settings.passes /
                               static_cast<double>(size) / kSeeds;
            }
        }
        cost.seconds =
            std::min(cost.seconds, static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
        for (std::size_t i = 0; i < size; ++i) {
            sums[i] += picture[i];
            squares[i] += picture[i] * picture[i];
        }
    }
    for (std::size_t i = 0; i < size; ++i) {
        const double mean = sums[i] / kSeeds;
        const double variance = (squares[i] / kSeeds - mean * mean) * kSeeds / (kSeeds - 1);
        cost.relativeVariance += variance / (mean * mean + 0.01) / static_cast<double>(size);
    }
    return cost;
}

// Ten thousand lamps, half of them hidden, take at most twice the time of ten to the same error.
TEST(ManyLights, TenThousandCostAtMostTwiceTen) {
    const Cost ten = costOf(Room(2, 5)), many = costOf(Room(100, 100));
    for (const auto& [lamps, cost] : {std::pair{10, &ten}, {10'000, &many}})
        fmt::print("    {:>6} lamps: {:.3f} s, error {:.3e}, {:.3f} s to 1e-3\n", lamps,
                   cost->seconds, cost->relativeVariance, cost->product() / 1e-3);
    fmt::print("    ratio {:.2f}\n", many.product() / ten.product());
    EXPECT_LT(many.relativeVariance / ten.relativeVariance, 1.5);
    // By power alone it is 4.9e-3.
    EXPECT_LT(many.relativeVariance, 1.5e-3);
}

}  // namespace
}  // namespace pm::test
