// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Many lights: the choice among them against the probabilities it states, light against sums over
// all lamps, and ten thousand lamps against ten.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <array>
#include <cmath>
#include <ctime>
#include <span>
#include <utility>

#include "integrator/geometry/polygon_mesh.h"
#include "integrator/scene/light_guide.h"
#include "integrator/scene/light_sampler.h"
#include "integrator/scene/light_tree.h"
#include "integrator/transport/lit_places.h"
#include "tests/integrator/scene_maker.h"
#include "tests/integrator/statistics.h"

namespace pm::test {
namespace {

constexpr double kSignificance = 0.01 / 20;

// Square lamps in a grid of rows x columns below a ceiling, facing down; all together they have
// the same area and radiance whatever their number.
void addLamps(SceneMaker& maker, std::uint32_t rows, std::uint32_t columns, double height) {
    constexpr double kArea = 0.2, kLow = -1.9, kWidth = 3.8;
    const double half = 0.5 * std::sqrt(kArea / (rows * columns));
    TriangleMesh mesh;
    for (std::uint32_t j = 0; j < rows; ++j)
        for (std::uint32_t i = 0; i < columns; ++i) {
            const double x = kLow + kWidth * (i + 0.5) / columns;
            const double z = kLow + kWidth * (j + 0.5) / rows;
            const auto a = static_cast<std::uint32_t>(mesh.positions.size());
            mesh.positions.push_back(Vec3f(Vec3d{x - half, height, z - half}));
            mesh.positions.push_back(Vec3f(Vec3d{x + half, height, z - half}));
            mesh.positions.push_back(Vec3f(Vec3d{x + half, height, z + half}));
            mesh.positions.push_back(Vec3f(Vec3d{x - half, height, z + half}));
            mesh.triangles.push_back({a, a + 1, a + 2});
            mesh.triangles.push_back({a, a + 2, a + 3});
        }
    mesh.materials.assign(mesh.triangles.size(), 0);
    mesh.faces.resize(mesh.triangles.size());
    InstanceDescription instance;
    instance.shape = std::make_shared<const TriangleMesh>(std::move(mesh));
    instance.materials = {maker.diffuse({}, Rgb(48.0f))};
    maker.description.instances.push_back(std::move(instance));
}

// A room of 4 x 3 x 4 with two boxes, half of whose lamps are above a slab. The camera sees no
// lamp: of that many a pixel would hold many, and noise of its own.
SceneMaker makeRoom(std::uint32_t rows, std::uint32_t columns) {
    SceneMaker maker;
    const auto white = maker.diffuse(Rgb(0.6f)), red = maker.diffuse({0.6f, 0.2f, 0.2f});
    maker.quad({-2, 0, 2}, {4, 0, 0}, {0, 0, -4}, white);
    maker.quad({-2, 3, -2}, {4, 0, 0}, {0, 0, 4}, white);
    maker.quad({-2, 0, -2}, {4, 0, 0}, {0, 3, 0}, white);
    maker.quad({-2, 0, 2}, {0, 0, -4}, {0, 3, 0}, red);
    maker.quad({2, 0, -2}, {0, 0, 4}, {0, 3, 0}, red);
    maker.box({-1.2, 0, -1.2}, {-0.4, 1.2, -0.4}, white, false);
    maker.box({0.5, 0, -0.6}, {1.3, 0.7, 0.4}, white, false);
    addLamps(maker, rows, columns, 2.95);
    maker.box({-2, 2.5, -2}, {0, 2.6, 2}, white, false);
    maker.camera({0, 2.6, 5.5}, {0, 0.9, -0.5}, {0, 1, 0}, 26);
    return maker;
}

struct Room {
    std::shared_ptr<const Scene> scene;
    RenderSettings settings = smallFrame(96, 72, IntegratorKind::kPhoton, 4, 3);
    std::unique_ptr<LightSampler> lights;

    Room(std::uint32_t rows, std::uint32_t columns)
        : scene(makeRoom(rows, columns).build()), lights(std::make_unique<LightSampler>(*scene)) {}

    std::vector<LitPlace> places() const {
        return findLitPlaces(*scene, Camera(*scene, settings.width, settings.height), settings);
    }
    void learn() { lights->learn(places(), settings.seed); }
    // What a ray along -direction from a point, world, meets.
    Surface seen(Vec3d from, Vec3d direction) const {
        Surface surface;
        const Ray ray{Vec3f(from - scene->centre()), Vec3f(normalize(direction))};
        EXPECT_TRUE(scene->intersect(ray, surface));
        return surface;
    }
    // A floor, a wall, a box's top that half the lamps don't reach, and the top of the slab, where
    // no camera ray comes.
    std::vector<Surface> receivers() const {
        return {seen({1, 1, 1}, {0, -1, 0}), seen({0, 1, 0.5}, {-1, 0, 0.1}),
                seen({-0.8, 2, -0.8}, {0, -1, 0}), seen({-1, 2.8, 0}, {0, -1, 0}),
                seen({0, 1, 1.5}, {0, 0.2, -1})};
    }
};

Receiver facing(const Surface& surface) {
    return {surface.position, surface.shadingNormal};
}

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
        const float radiance = scene.material(light.material).emission.g;
        sum += static_cast<double>(radiance * light.area * in * out / d2);
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

// By the tree alone, and with a table before it: probabilities add up to 1, and choices follow
// them (chi-squared).
TEST(ManyLights, ChoicesFollowTheirProbabilities) {
    // More than a leaf each, so that runs are tried too.
    for (const std::uint32_t side : {8u, 60u}) {
        const Room room(side, side);
        LightTree tree(*room.scene);
        const auto surfaces = room.receivers();
        std::vector<Receiver> receivers;
        for (const Surface& surface : surfaces) receivers.push_back(facing(surface));
        const LightGuide guide(tree, receivers,
                               [&](std::size_t i, std::uint32_t node, std::uint32_t n) {
                                   LightDescent descent{0.25 * n, node};
                                   tree.choose(receivers[i], {&descent, 1});
                                   return Sighting{descent.node, (node + i) % 3 == 0};
                               });
        const std::size_t count = room.scene->lights().size();
        const auto check = [&](const auto& choose, const auto& probability) {
            Random random(3);
            Histogram histogram(count);
            double sum = 0;
            for (std::uint32_t i = 0; i < count; ++i) {
                const auto p = static_cast<double>(probability(i));
                EXPECT_GT(p, 0.0);
                sum += p;
                histogram.expect(i, p);
            }
            EXPECT_NEAR(sum, 1.0, 1e-4);
            double mean = 0, wrong = 0;
            const std::size_t samples = 200'000;
            std::size_t total = 0;
            // In batches of any size: side by side all are chosen as they would be alone.
            for (std::size_t done = 0, size = 1; done < samples; size = size % 16 + 1) {
                std::array<LightDescent, 16> batch;
                const std::span<LightDescent> descents(batch.data(), size);
                for (LightDescent& descent : descents) {
                    const auto fine = static_cast<double>(random.next());
                    descent.u = static_cast<double>(random.next()) + fine * 0x1p-24;
                }
                const std::array<LightDescent, 16> before = batch;
                choose(descents);
                for (std::size_t i = 0; i < size; ++i) {
                    LightDescent alone = before[i];
                    choose({&alone, 1});
                    const auto& [u, light, p] = descents[i];
                    EXPECT_TRUE(alone.node == light && alone.u == u && alone.probability == p);
                    wrong += std::abs(p / probability(light) - 1.0f) > 1e-4f;
                    histogram.count(light);
                    EXPECT_TRUE(u >= 0 && u < 1);
                    mean += u;
                }
                done += size;
                total = done;
            }
            mean /= static_cast<double>(total);
            EXPECT_EQ(wrong, 0);
            EXPECT_GT(histogram.pValue(0), kSignificance);
            // What is left of u is uniform.
            EXPECT_NEAR(mean, 0.5, 5 / std::sqrt(12.0 * static_cast<double>(total)));
        };
        for (const Receiver& receiver : receivers) {
            check([&](std::span<LightDescent> descents) { tree.choose(receiver, descents); },
                  [&](std::uint32_t i) { return tree.probability(LightTree::kRoot, receiver, i); });
            check([&](std::span<LightDescent> descents) { guide.choose(receiver, descents); },
                  [&](std::uint32_t i) { return guide.probability(receiver, i); });
        }
    }
}

// Lights chosen together are those that are chosen one by one, near and far ones in any order, in
// batches longer than any that are made side by side, too.
TEST(ManyLights, ChosenTogetherAsAlone) {
    for (const std::uint32_t side : {2u, 30u}) {
        SceneMaker maker = makeRoom(side, side);
        maker.description.directionalLights.push_back({{0.2, -1, 0.1}, Rgb(3.0f), 0.1, "sun"});
        Room room(side, side);
        room.scene = maker.build();
        room.lights = std::make_unique<LightSampler>(*room.scene);
        room.learn();
        const Surface at = room.receivers().front();
        Random random(9);
        std::size_t far = 0, total = 0;
        for (std::size_t size = 1; size < 70; size = size * 3 / 2 + 1) {
            std::vector<ChosenLight> together(size);
            for (ChosenLight& one : together) one.u = random.next2D();
            const std::vector<ChosenLight> before = together;
            room.lights->choose(at, at.geometricNormal, together);
            for (std::size_t i = 0; i < size; ++i) {
                ChosenLight alone = before[i];
                room.lights->choose(at, at.geometricNormal, {&alone, 1});
                EXPECT_EQ(alone.light, together[i].light);
                EXPECT_EQ(alone.u, together[i].u);
                EXPECT_EQ(alone.probability, together[i].probability);
                far += alone.light >= room.scene->nearLights().size();
            }
            total += size;
        }
        EXPECT_GT(far, 0);
        EXPECT_LT(far, total);
    }
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
    EXPECT_GT(behind, 20);
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
        if (scene->material(scene->lights()[light].material).emission.r < 1.0f)
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
