// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Aimed emission: the expectation of the unaimed, more of it where caustics are cast.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <array>
#include <cmath>
#include <cstring>
#include <functional>

#include "integrator/photons/emission/aimed_emission.h"
#include "integrator/photons/trace/photon_tracer.h"
#include "integrator/sampling/sampler.h"
#include "tests/support/aimed.h"
#include "tests/support/hit_share.h"
#include "tests/support/scene_maker.h"

namespace pm::test {
namespace {

std::uint32_t addGlass(SceneMaker& maker) {
    MaterialDescription m;
    m.kind = MaterialKind::kDielectric;
    m.ior = 1.5f;
    m.transmission = {1.0f, 0.8f, 0.6f};
    return maker.material(m);
}

std::uint32_t addMirror(SceneMaker& maker) {
    MaterialDescription m;
    m.kind = MaterialKind::kMirror;
    m.glossy = {0.9f, 0.8f, 0.7f};
    return maker.material(m);
}

std::uint32_t lamp(SceneMaker& maker) {
    return maker.diffuse({}, {3, 2, 1});
}

// Walls around [-1, 1]^3 that reflect diffusely.
SceneMaker room() {
    SceneMaker maker;
    maker.box({-1, -1, -1}, {1, 1, 1}, maker.diffuse(Rgb(0.5f)), true);
    return maker;
}

// Faces down from y.
void ceilingLamp(SceneMaker& maker, double y, double half, Vec3d at = {}) {
    maker.quad(at + Vec3d{-half, y, -half}, {2 * half, 0, 0}, {0, 0, 2 * half}, lamp(maker));
}

struct TestScene {
    const char* name;
    std::function<void(SceneMaker&)> add;
};

std::vector<TestScene> testScenes() {
    const auto ball = [](SceneMaker& m, Vec3d at, double radius) {
        m.sphere(at, radius, addGlass(m));
    };
    return {
        {"area light",
         [=](SceneMaker& m) {
             ceilingLamp(m, 0.9, 0.2);
             ball(m, {0.2, -0.4, 0.1}, 0.3);
         }},
        {"sphere light",
         [=](SceneMaker& m) {
             m.sphere({-0.3, 0.5, 0.2}, 0.2, lamp(m));
             ball(m, {0.3, -0.5, 0.1}, 0.2);
             m.sphere({0.4, 0.5, -0.3}, 0.15, addMirror(m));
         }},
        {"sphere light smaller than its caster",
         [=](SceneMaker& m) {
             m.sphere({-0.2, 0.5, 0}, 0.05, lamp(m));
             ball(m, {0.1, -0.3, 0.1}, 0.5);
         }},
        {"point light",
         [=](SceneMaker& m) {
             m.pointLight({-0.3, 0.6, 0.2}, {1, 2, 3});
             ball(m, {0.3, -0.5, 0.1}, 0.25);
         }},
        {"point light outside",
         [=](SceneMaker& m) {
             m.description.instances.pop_back();  // the front wall
             m.pointLight({0.3, 0.2, 9}, {100, 200, 300});
             ball(m, {0.1, 0.1, 0.1}, 0.3);
         }},
        {"half hidden caster",
         [=](SceneMaker& m) {
             ceilingLamp(m, 0.9, 0.3);
             ball(m, {0, -0.6, 0}, 0.3);
             ball(m, {0.6, -0.6, 0.5}, 0.2);
             m.quad({-0.1, 0, -0.9}, {0.8, 0, 0}, {0, 0, 1.8}, m.diffuse(Rgb(0.3f)));
         }},
        {"caster that touches the light",
         [=](SceneMaker& m) {
             ceilingLamp(m, 0.5, 0.3);
             ball(m, {0.1, 0.199, 0}, 0.3);
         }},
        {"caster cut by the light's plane",
         [=](SceneMaker& m) {
             ceilingLamp(m, 0.3, 0.2);
             ball(m, {0.6, 0.35, 0}, 0.3);
             ball(m, {-0.6, 0.25, 0.1}, 0.3);
         }},
        {"light inside its caster",
         [=](SceneMaker& m) {
             m.pointLight({0.05, 0.1, 0}, {1, 1, 2});
             m.sphere({-0.3, 0.2, 0.1}, 0.1, lamp(m));
             m.meshSphere({-0.1, 0.1, 0}, 0.6, addGlass(m), false, 8);
         }},
        {"many lights, half of them hidden",
         [=](SceneMaker& m) {
             for (int i = 0; i < 300; ++i)
                 ceilingLamp(m, i % 2 ? 0.9 : 0.97, 0.02,
                             {-0.9 + 0.11 * (i % 17), 0, -0.9 + 0.1 * (i / 17)});
             m.quad({-0.95, 0.94, -0.95}, {1.9, 0, 0}, {0, 0, 0.9}, m.diffuse(Rgb(0.2f)));
             ball(m, {0.2, -0.4, 0.1}, 0.3);
         }},
        {"two casters, one behind the other",
         [=](SceneMaker& m) {
             ceilingLamp(m, 0.95, 0.15);
             ball(m, {0, 0.2, 0}, 0.25);
             ball(m, {0.1, -0.6, 0.1}, 0.35);
         }},
        {"everything a little glossy",
         [=](SceneMaker& m) {
             MaterialDescription& walls = m.description.materials[0];
             walls.glossy = Rgb(0.2f);
             walls.glossyExponent = 60;
             ceilingLamp(m, 0.9, 0.2);
             m.pointLight({0.5, 0.5, 0.5}, Rgb(0.2f));
         }},
        {"mirrors as meshes",
         [=](SceneMaker& m) {
             ceilingLamp(m, 0.9, 0.2);
             m.quad({-0.9, -0.5, -0.8}, {1.2, 0, 0}, {0, 0.3, -0.1}, addMirror(m), 4);
             m.box({0.3, -0.9, 0.1}, {0.6, -0.5, 0.5}, addGlass(m), false);
         }},
    };
}

std::shared_ptr<const Scene> build(const TestScene& test) {
    SceneMaker maker = room();
    test.add(maker);
    return maker.build();
}

// Of the photons that landed: flux, its moments over places (red), and over the normal's y.
constexpr std::size_t kMoments = 7;
std::array<double, kMoments> moments(const PhotonTraceResult& result) {
    std::array<double, kMoments> sum{};
    for (const Photon& photon : result.photons) {
        const auto red = static_cast<double>(photon.flux.r);
        const Vec3d p(photon.position);
        const std::array<double, kMoments> values = {
            red,
            static_cast<double>(photon.flux.g),
            static_cast<double>(photon.flux.b),
            red * p.x * p.x,
            red * p.y,
            red * p.z * p.x,
            red * static_cast<double>(photon.normal.unpack().y)};
        for (std::size_t i = 0; i < kMoments; ++i) sum[i] += values[i];
    }
    return sum;
}

struct Spread {
    std::array<double, kMoments> mean{}, squaredError{};
};

Spread spreadOf(const Aimed& aimed, bool aim, int replicates, std::uint64_t photons) {
    std::vector<std::array<double, kMoments>> all;
    Spread spread;
    for (int i = 0; i < replicates; ++i)
        all.push_back(moments(
            aimed.trace(PhotonKind::kCaustic, photons, static_cast<std::uint64_t>(i) + 10, aim)));
    for (std::size_t k = 0; k < kMoments; ++k) {
        for (const auto& one : all) spread.mean[k] += one[k] / replicates;
        for (const auto& one : all)
            spread.squaredError[k] += (one[k] - spread.mean[k]) * (one[k] - spread.mean[k]) /
                                      (replicates * (replicates - 1.0));
    }
    return spread;
}

TEST(AimedEmission, LandsTheFluxOfTheUnaimed) {
    constexpr int kReplicates = 24;
    for (const TestScene& test : testScenes()) {
        const Aimed aimed(build(test));
        ASSERT_FALSE(aimed.aim.empty()) << test.name;
        const Spread want = spreadOf(aimed, false, kReplicates, 25'000);
        const Spread got = spreadOf(aimed, true, kReplicates, 10'000);
        ASSERT_GT(want.mean[0], 0.0) << test.name;
        for (std::size_t k = 0; k < kMoments; ++k) {
            const double sigma = std::sqrt(want.squaredError[k] + got.squaredError[k]);
            EXPECT_LT(std::abs(got.mean[k] - want.mean[k]), 4 * sigma)
                << fmt::format("{}, moment {}: aimed {:.5f} +- {:.5f}, unaimed {:.5f} +- {:.5f}",
                               test.name, k, got.mean[k], std::sqrt(got.squaredError[k]),
                               want.mean[k], std::sqrt(want.squaredError[k]));
        }
    }
}

TEST(AimedEmission, EnergyIsConserved) {
    for (const TestScene& test : testScenes()) {
        const Aimed aimed(build(test));
        const PhotonBalance b = aimed.trace(PhotonKind::kCaustic, 50'000, 1, true).balance;
        EXPECT_NEAR((b.fluxAbsorbed + b.fluxEscaped + b.fluxLost) / b.fluxEmitted, 1, 1e-6);
        EXPECT_EQ(b.emitted, 50'000u);
    }
}

// A glass that fills 1/1000 of the solid angle that a light shines into (of an area light by the
// cosine) is hit by at least half of the photons aimed at it.
TEST(AimedEmission, SmallGlassIsHit) {
    const double d = 1.2;
    const std::array<Vec3d, 3> ways = {Vec3d{0, -1, 0}, normalize(Vec3d{1, -1, 0.3}),
                                       normalize(Vec3d{1, -0.2, 0.1})};
    enum class Lamp { kArea, kSphere, kPoint };
    for (const Lamp kind : {Lamp::kArea, Lamp::kSphere, Lamp::kPoint})
        for (const Vec3d& way : ways)
            for (const bool asBox : {false, true}) {
                SceneMaker maker;
                maker.box({-3, -3, -3}, {3, 3, 3}, maker.diffuse(Rgb(0.5f)), true);
                // 1/1000: r^2 cos / d^2 of an area light, r^2 / 4 d^2 of the others.
                double radius = d * std::sqrt(4.0 / 1000);
                if (kind == Lamp::kArea) {
                    ceilingLamp(maker, 0, 0.1);
                    radius = d * std::sqrt(1.0 / 1000 / -way.y);
                } else if (kind == Lamp::kSphere) {
                    maker.sphere({0, 0, 0}, 0.1, lamp(maker));
                } else {
                    maker.pointLight({0, 0, 0}, Rgb(1.0f));
                }
                const double h = radius * 0.77;  // as large a cross section on the average
                if (asBox)
                    maker.box(way * d - Vec3d(h), way * d + Vec3d(h), addGlass(maker), false);
                else
                    maker.sphere(way * d, radius, addGlass(maker));
                const double share = hitShare(maker, 50'000);
                EXPECT_GE(share, asBox ? 0.5 : 0.9)
                    << static_cast<int>(kind) << " " << way.x << " " << asBox;
            }
}

// No photon carries more than the unaimed flux over the unaimed share, and those that land are
// alike.
TEST(AimedEmission, WeightsAreBounded) {
    for (const TestScene& test : testScenes()) {
        const Aimed aimed(build(test));
        double largest = 0;
        for (std::uint32_t i = 0; i < 100'000; ++i) {
            const Sampler sampler(1, 1, 0, i);
            const Vec2f choice = sampler.get2D(Purpose::kLight);
            const Vec2f point = sampler.get2D(Purpose::kPlace);
            AimedPhoton photon;
            if (!aimed.aim.emit(choice, point, sampler.get2D(Purpose::kDirection), photon))
                continue;
            ASSERT_TRUE(isFinite(photon.flux));
            const Light& light = aimed.scene->lights()[photon.light];
            const double mean =
                (static_cast<double>(photon.flux.r) + photon.flux.g + photon.flux.b) / 3;
            largest = std::max(
                largest, mean * static_cast<double>(aimed.aim.lightProbability(photon.light)) /
                             light.powerMean);
        }
        // Of sphere lights a tenth of the points is chosen evenly.
        EXPECT_LE(largest, 1.001 / 0.05 / 0.1) << test.name;
        const PhotonTraceResult landed = aimed.trace(PhotonKind::kCaustic, 50'000, 1, true);
        double most = 0, sum = 0;
        for (const Photon& photon : landed.photons) {
            most = std::max(most, static_cast<double>(photon.flux.g));
            sum += static_cast<double>(photon.flux.g);
        }
        EXPECT_LT(most, 30 * sum / static_cast<double>(landed.photons.size())) << test.name;
    }
}

TEST(AimedEmission, TheSameBitsForAnyThreads) {
    const tbb::global_control allow(tbb::global_control::max_allowed_parallelism, 2);
    const auto scene = build(testScenes()[9]);
    const auto run = [&](int threads) {
        PhotonTraceResult result;
        tbb::task_arena(threads).execute(
            [&] { result = Aimed(scene).trace(PhotonKind::kCaustic, 30'001, 3, true); });
        return result;
    };
    const PhotonTraceResult one = run(1), two = run(2);
    ASSERT_EQ(one.photons.size(), two.photons.size());
    EXPECT_EQ(
        std::memcmp(one.photons.data(), two.photons.data(), one.photons.size() * sizeof(Photon)),
        0);
    EXPECT_EQ(one.balance.fluxEmitted, two.balance.fluxEmitted);
}

// What a pilot can't reach gets few photons; a light that reaches nothing gets the floor.
TEST(AimedEmission, LearnsWhatIsHidden) {
    SceneMaker maker = room();
    ceilingLamp(maker, 0.9, 0.1, {0.5, 0, 0});
    ceilingLamp(maker, 0.9, 0.1, {-0.5, 0, 0});
    maker.sphere({0.6, -0.7, 0.3}, 0.2, addGlass(maker));
    maker.sphere({-0.6, -0.7, 0.3}, 0.2, addGlass(maker));
    // A lid over the left lamp; the right one sees both balls but for the left one's cover.
    maker.quad({-0.9, 0.8, -0.5}, {0.8, 0, 0}, {0, 0, 1}, maker.diffuse(Rgb(0.2f)));
    maker.quad({-0.9, -0.4, -0.1}, {0.65, 0, 0}, {0, 0, 0.8}, maker.diffuse(Rgb(0.2f)));
    const auto scene = maker.build();
    const Aimed guess(scene, false), learned(scene);
    const auto share = [](const Aimed& aimed) {
        const PhotonTraceResult r = aimed.trace(PhotonKind::kCaustic, 50'000, 5, true);
        return static_cast<double>(r.balance.stored) / static_cast<double>(r.balance.emitted);
    };
    EXPECT_GT(share(learned), 1.7 * share(guess));
    EXPECT_GT(share(learned), 0.5);
    // Lights 0 and 1 are the right lamp.
    for (const std::size_t hidden : {2u, 3u}) {
        EXPECT_LT(learned.aim.lightProbability(hidden), 0.06f);
        EXPECT_GE(learned.aim.lightProbability(hidden), 0.1f / 4 * 0.99f);
    }
    const std::size_t left = learned.aim.casters()[0].centre.x < 0 ? 0 : 1;
    EXPECT_LT(learned.aim.worth(0, left), 0.3f);
    EXPECT_GT(learned.aim.worth(0, 1 - left), 0.8f);
}

TEST(AimedEmission, NothingToAimAt) {
    SceneMaker maker = room();
    ceilingLamp(maker, 0.9, 0.1);
    const Aimed none(maker.build());
    EXPECT_TRUE(none.aim.empty());
    const auto with = none.trace(PhotonKind::kGlobal, 1000, 1, true);
    const auto without = none.trace(PhotonKind::kGlobal, 1000, 1, false);
    ASSERT_EQ(with.photons.size(), without.photons.size());
    EXPECT_EQ(std::memcmp(with.photons.data(), without.photons.data(),
                          with.photons.size() * sizeof(Photon)),
              0);
    SceneMaker dark = room();
    dark.sphere({0, 0, 0}, 0.3, addGlass(dark));
    EXPECT_TRUE(Aimed(dark.build()).aim.empty());
}

// 10,000 lights and 64 casters: memory by their sum.
TEST(AimedEmission, ManyLightsCostLittle) {
    SceneMaker maker = room();
    const auto material = lamp(maker);
    maker.quad({-0.9, 0.9, -0.9}, {1.8, 0, 0}, {0, 0, 1.8}, material, 71);
    const auto g = addGlass(maker);
    for (int i = 0; i < 100; ++i)
        maker.sphere({-0.9 + 0.2 * (i % 10), -0.5, -0.9 + 0.2 * (i / 10)}, 0.03, g);
    const Aimed aimed(maker.build());
    EXPECT_EQ(aimed.scene->lights().size(), 2u * 71 * 71);
    EXPECT_GT(aimed.aim.casters().size(), 40u);
    EXPECT_LT(aimed.aim.memoryBytes(), 500'000u);
}

}  // namespace
}  // namespace pm::test
