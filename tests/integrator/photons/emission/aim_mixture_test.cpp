// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Directions towards casters against the density they state; casters against what they must hold.
#include "integrator/photons/emission/aim_mixture.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "integrator/light_sampling/light_sampler.h"
#include "integrator/photons/emission/caustic_casters.h"
#include "tests/support/scene_maker.h"
#include "tests/support/statistics.h"

namespace pm::test {
namespace {

constexpr double kSignificance = 0.01 / 20;

EmissionPoint onSurface(Vec3d position, Vec3f normal) {
    EmissionPoint point;
    point.position = position;
    point.axis = normalize(normal);
    point.onSurface = true;
    return point;
}

EmissionPoint inSpace(Vec3d position) {
    EmissionPoint point;
    point.position = position;
    point.axis = {0, 0, 1};
    return point;
}

struct Aim {
    const char* name;
    EmissionPoint from;
    std::vector<Caster> casters;
    std::vector<float> worth;
};

std::vector<Aim> aims() {
    const EmissionPoint surface = onSurface({0, 0, 0}, {0, 0, 1}), space = inSpace({0, 0, 0});
    const EmissionPoint tilted = onSurface({0.1, 0.2, 0.3}, {0.5f, -0.3f, 0.8f});
    return {
        {"one above", surface, {{{0.3, 0.2, 2}, 0.7}}, {1}},
        {"cut by the plane", surface, {{{1.5, 0, 0.2}, 0.6}}, {1}},
        {"centre behind the plane", surface, {{{1.5, 0, -0.2}, 0.6}}, {1}},
        {"behind, and one above", surface, {{{0, 0, -2}, 0.5}, {{0, 1, 1}, 0.5}}, {1, 1}},
        {"inside, and one beside", surface, {{{0, 0, 0.3}, 0.5}, {{2, 0, 1}, 0.5}}, {1, 1}},
        {"two that overlap", surface, {{{0, 0, 2}, 0.8}, {{0.6, 0, 3}, 1.1}}, {1, 0.3f}},
        {"almost touching", surface, {{{0, 0, 0.51}, 0.5}, {{2, 1, 1}, 0.9}}, {1, 1}},
        {"tilted", tilted, {{{2, 0, 1}, 0.9}, {{0, 2, 0}, 0.8}, {{-1, -1, 2}, 1}}, {1, 2, 0.1f}},
        {"a box", surface, {{{0.5, 0.3, 1.2}, 0.6, {0.3, 0.3, 0.424}, true}}, {1}},
        {"a point light", space, {{{1, 1, 1}, 0.6}, {{-1, 0, 1}, 0.9}}, {1, 0.5f}},
        {"a point light within", space, {{{0.1, 0, 0}, 0.6}, {{-1, 0, 1}, 0.9}}, {1, 0.5f}},
    };
}

// No cone's edge runs along its bins.
DirectionTest slanting() {
    DirectionTest test;
    test.axis = normalize(Vec3f{0.4f, -0.7f, 0.3f});
    test.cosineBins = 32;
    test.subdivisions = 40;
    return test;
}

TEST(AimMixture, SamplesItsDensity) {
    std::uint64_t seed = 1;
    for (const Aim& aim : aims()) {
        const AimMixture mixture(aim.casters, aim.worth, aim.from);
        Random random(seed++);
        DirectionTest test = slanting();
        int wrong = 0;
        const auto sample = [&]() -> std::optional<Vec3f> {
            AimMixture::Sample s;
            const float u = random.next();
            if (!mixture.sample(u, random.next2D(), s)) return std::nullopt;
            // On an edge the two may differ, since the sample's own part is not asked again.
            wrong += std::abs(mixture.pdfSolidAngle(s.direction) / s.pdfSolidAngle - 1) > 1e-3f;
            return s.direction;
        };
        const auto density = [&](const Vec3f& d) {
            return static_cast<double>(mixture.pdfSolidAngle(d));
        };
        EXPECT_GT(test.pValue(sample, density), kSignificance) << aim.name;
        EXPECT_LT(wrong, 20) << aim.name;
    }
}

// Twin: the density of one strategy is forgotten.
TEST(AimMixture, AForgottenStrategyIsRefused) {
    const Aim aim = aims()[5];
    const AimMixture mixture(aim.casters, aim.worth, aim.from);
    AimCone cone;
    ASSERT_TRUE(cone.aim(aim.casters[1], aim.from));
    Random random(1);
    const DirectionTest test = slanting();
    const auto sample = [&]() -> std::optional<Vec3f> {
        AimMixture::Sample s;
        const float u = random.next();
        if (!mixture.sample(u, random.next2D(), s)) return std::nullopt;
        return s.direction;
    };
    const auto density = [&](const Vec3f& d) {
        return static_cast<double>(mixture.pdfSolidAngle(d) - 0.05f * cone.pdfSolidAngle(d));
    };
    EXPECT_LT(test.pValue(sample, density), kSignificance);
}

// Every direction to a sphere lies within its cone, from anywhere; where it is not aimed at, it
// can't be seen.
TEST(AimCone, HoldsTheWholeSphere) {
    Random random(2);
    const auto any = [&] { return Vec3d(sampleUniformSphere(random.next2D())); };
    for (int i = 0; i < 200'000; ++i) {
        const double radius = std::pow(10.0, -4.0 * static_cast<double>(random.next()));
        const Caster sphere{any() * 3, radius};
        const EmissionPoint from = i % 2 ? onSurface(any() * 2, Vec3f(any())) : inSpace(any() * 2);
        const Vec3d to = sphere.centre + any() * radius - from.position;
        const Vec3f direction(normalize(to));
        if (from.onSurface && dot(direction, from.axis) <= 1e-6f) continue;
        AimCone cone;
        ASSERT_TRUE(cone.aim(sphere, from));
        if (!cone.all) {
            ASSERT_GT(cone.pdfSolidAngle(direction), 0.0f) << i;
        }
    }
}

TEST(AimCone, HoldsTheWholeBox) {
    Random random(4);
    const auto any = [&] { return Vec3d(sampleUniformSphere(random.next2D())); };
    int narrower = 0;
    for (int i = 0; i < 100'000; ++i) {
        const Vec3d half = {0.1 + random.next(), 0.1 + random.next(), 0.1 + random.next()};
        const Caster box{any() * 3, length(half), half, true};
        const EmissionPoint from = i % 2 ? onSurface(any() * 2, Vec3f(any())) : inSpace(any() * 2);
        const auto within = [&] { return 2.0 * static_cast<double>(random.next()) - 1; };
        const Vec3d place = box.centre + half * Vec3d{within(), within(), within()};
        const Vec3f direction(normalize(place - from.position));
        if (from.onSurface && dot(direction, from.axis) <= 1e-6f) continue;
        AimCone cone, sphereCone;
        ASSERT_TRUE(cone.aim(box, from));
        if (!cone.all) {
            ASSERT_GT(cone.pdfSolidAngle(direction), 0.0f) << i;
        }
        const Caster sphere{box.centre, box.radius};
        sphereCone.aim(sphere, from);
        narrower += cone.solidAngle < 0.9f * sphereCone.solidAngle;
    }
    EXPECT_GT(narrower, 5000);
}

// The farthest corners of the unit square, on cones from a hair's breadth to a half space: a
// density that rounds to 0 would make infinite flux.
TEST(AimMixture, EdgesHaveADensity) {
    constexpr float kLast = 1.0f - 0x1p-24f;
    for (const double radius : {1e-7, 1e-5, 1e-3, 0.1, 0.9, 0.99999})
        for (const EmissionPoint& from : {onSurface({0, 0, 0}, {0, 0, 1}), inSpace({0, 0, 0})})
            for (const Vec3d& to : {Vec3d{0, 0, 1}, Vec3d{0.6, 0, 0.8}, Vec3d{0, 1, 1e-4}}) {
                const std::vector<Caster> casters = {{to, radius}};
                const std::vector<float> worth = {1};
                const AimMixture mixture(casters, worth, from);
                for (int i = 0; i <= 64; ++i) {
                    AimMixture::Sample s;
                    if (!mixture.sample(0.5f, {kLast, static_cast<float>(i) / 64}, s)) continue;
                    ASSERT_TRUE(isFinite(s.direction) && std::isfinite(s.pdfSolidAngle));
                    if (s.caster == kNoCaster || radius > 0.95) continue;
                    // 0.95 over the solid angle of the cone at least.
                    const double widened = radius * 1.001 + 1.01e-6;
                    ASSERT_GT(static_cast<double>(s.pdfSolidAngle) * widened * widened, 0.14);
                }
            }
}

std::vector<Caster> castersOf(const SceneMaker& maker) {
    const auto scene = maker.build();
    const LightSampler lights(*scene);
    std::vector<EmissionPoint> views;
    for (const Light& light : scene->lights()) views.push_back(inSpace(light.position()));
    return findCasters(*scene, views);
}

std::uint32_t glass(SceneMaker& maker) {
    MaterialDescription m;
    m.kind = MaterialKind::kDielectric;
    return maker.material(m);
}

TEST(CausticCasters, OnlyWhatIsNotDiffuse) {
    MaterialDescription m;
    m.diffuse = Rgb(0.5f);
    EXPECT_FALSE(traitsOf({&m, 1}, {})[0].castsCaustics);
    m.transparency = 0.5f;
    EXPECT_FALSE(traitsOf({&m, 1}, {})[0].castsCaustics);
    m = {};
    m.glossy = {0, 0.1f, 0};
    m.glossyExponent = LobeRoles{}.broadExponent;
    EXPECT_FALSE(traitsOf({&m, 1}, {})[0].castsCaustics);
    m.glossyExponent *= 1.01f;
    EXPECT_TRUE(traitsOf({&m, 1}, {})[0].castsCaustics);
    m.glossy *= 1e-6f;
    EXPECT_FALSE(traitsOf({&m, 1}, {})[0].castsCaustics);
    m.glossyTexture = 0;
    EXPECT_TRUE(traitsOf({&m, 1}, {})[0].castsCaustics);
    m = {};
    m.kind = MaterialKind::kMirror;
    EXPECT_FALSE(traitsOf({&m, 1}, {})[0].castsCaustics);
    m.fresnelMirror = true;
    EXPECT_TRUE(traitsOf({&m, 1}, {})[0].castsCaustics);
    m.fresnelMirror = false;
    m.glossy = Rgb(0.1f);
    EXPECT_TRUE(traitsOf({&m, 1}, {})[0].castsCaustics);
    m.glossyExponent = 20;
    EXPECT_FALSE(traitsOf({&m, 1}, {})[0].castsCaustics);
    m = {};
    m.kind = MaterialKind::kDielectric;
    EXPECT_TRUE(traitsOf({&m, 1}, {})[0].castsCaustics);
    m.ior = 1;
    EXPECT_FALSE(traitsOf({&m, 1}, {})[0].castsCaustics);
    // Tinted it bends as little; over other glass, by its priority, it does.
    m.transmission.g = 0.9f;
    EXPECT_FALSE(traitsOf({&m, 1}, {})[0].castsCaustics);
    m.priority = 1;
    EXPECT_TRUE(traitsOf({&m, 1}, {})[0].castsCaustics);
    SceneMaker maker;
    maker.box({-1, -1, -1}, {1, 1, 1}, maker.diffuse(Rgb(0.5f)), true);
    maker.pointLight({0, 0, 0}, Rgb(1.0f));
    EXPECT_TRUE(castersOf(maker).empty());
}

TEST(CausticCasters, AsManyAsTheyAreWorth) {
    SceneMaker ball;
    ball.meshSphere({1, 2, 3}, 0.5, glass(ball), false, 40);
    ball.pointLight({-2, 0, 0}, Rgb(1.0f));
    const auto one = castersOf(ball);
    ASSERT_EQ(one.size(), 1u);
    EXPECT_NEAR(one[0].radius, 0.5, 1e-4);

    // Balls far apart, though halving their lattice would gain nothing at first.
    SceneMaker lattice;
    const auto material = glass(lattice);
    for (int i = 0; i < 64; ++i)
        lattice.sphere({1.0 * (i % 4), 1.0 * (i / 4 % 4), 1.0 * (i / 16)}, 0.05, material);
    lattice.pointLight({-2, 0, 0}, Rgb(1.0f));
    const auto balls = castersOf(lattice);
    ASSERT_EQ(balls.size(), 64u);
    for (const Caster& caster : balls) EXPECT_NEAR(caster.radius, 0.05, 1e-5);

    // A thin rod in pieces.
    SceneMaker rod;
    rod.quad({0, 0, 0}, {20, 0, 0}, {0, 0, 0.5}, glass(rod), 40);
    rod.pointLight({10, -3, 0}, Rgb(1.0f));
    EXPECT_GT(castersOf(rod).size(), 10u);

    // More balls than there may be casters.
    SceneMaker many;
    const auto m = glass(many);
    for (int i = 0; i < 1000; ++i)
        many.sphere({1.0 * (i % 10), 1.0 * (i / 10 % 10), 1.0 * (i / 100)}, 0.05, m);
    many.pointLight({-2, 0, 0}, Rgb(1.0f));
    EXPECT_LE(castersOf(many).size(), kMostFound);
}

// Every corner of what casts, under a transform, lies in some caster.
TEST(CausticCasters, HoldEverything) {
    SceneMaker maker;
    Random random(3);
    const auto material = glass(maker);
    for (int i = 0; i < 30; ++i) {
        const Vec3d at = Vec3d(sampleUniformSphere(random.next2D())) * 4;
        maker.meshSphere(at, 0.1 + static_cast<double>(random.next()), material, false, 6);
        maker.description.instances.back().transform = {0, -2, 0, 1, 1, 0, 0, 2, 0, 0, 0.5, 3};
    }
    maker.pointLight({0, 0, 0}, Rgb(1.0f));
    const auto scene = maker.build();
    const auto casters = castersOf(maker);
    for (std::uint32_t shape = 0; shape < 30; ++shape)
        for (int i = 0; i < 100; ++i) {
            SurfaceLight triangle;
            triangle.shape = shape;
            triangle.primitive = static_cast<std::uint32_t>(i);
            const Vec3d p(scene->pointOnLight(triangle, random.next2D()).position);
            bool held = false;
            for (const Caster& caster : casters)
                held |= length(p - caster.centre) <= caster.radius * (1 + 1e-5);
            ASSERT_TRUE(held);
        }
}

}  // namespace
}  // namespace pm::test
