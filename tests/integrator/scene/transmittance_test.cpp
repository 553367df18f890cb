// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// What shadow rays go through: cut-outs and half-transparent sheets.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <numbers>

#include "integrator/materials/bsdf.h"
#include "integrator/photons/emission/caustic_casters.h"
#include "integrator/transport/path/direct_light.h"
#include "integrator/transport/plan/plan.h"
#include "tests/support/rooms.h"
#include "tests/support/scene_maker.h"
#include "tests/support/sky_picture.h"

namespace pm::test {
namespace {

bool castsCaustics(const MaterialDescription& material) {
    return traitsOf({&material, 1}, {})[0].castsCaustics;
}

MaterialDescription sheet(float transparency, float reflectance = 0.0f) {
    MaterialDescription m;
    m.diffuse = Rgb(reflectance);
    m.transparency = transparency;
    return m;
}

// Along z through the origin, past a quad of each of the materials, at heights 1, 2, ...
std::shared_ptr<const Scene> stackOf(const std::vector<MaterialDescription>& materials) {
    SceneMaker maker;
    double height = 0;
    for (const MaterialDescription& m : materials)
        maker.quad({-1, -1, ++height}, {2, 0, 0}, {0, 2, 0}, maker.material(m));
    return maker.build();
}

float along(const Scene& scene, Vec3d from, Vec3d to) {
    const Vec3f origin(from - scene.centre());
    return scene.transmittance({origin, Vec3f(to - scene.centre()) - origin, 1.0f}).g;
}

TEST(Transmittance, IsTheProductOfWhatIsCrossed) {
    const auto scene = stackOf({sheet(0.5f), sheet(0.25f, 0.5f), sheet(0.8f)});
    EXPECT_EQ(along(*scene, {0.3, 0.1, 0}, {0.3, 0.1, 4}), 0.5f * 0.25f * 0.8f);
    EXPECT_EQ(along(*scene, {0.3, 0.1, 4}, {0.3, 0.1, 0}), 0.8f * 0.25f * 0.5f);
    // From the first to before the third, and beside them all.
    EXPECT_EQ(along(*scene, {0.3, 0.1, 0}, {0.3, 0.1, 2.9}), 0.5f * 0.25f);
    EXPECT_EQ(along(*scene, {3, 0, 0}, {3, 0, 4}), 1.0f);
}

TEST(Transmittance, WhatStopsLightStopsAll) {
    MaterialDescription clear = glass();
    EXPECT_EQ(along(*stackOf({sheet(0.5f), sheet(0.0f)}), {0, 0.1, 0}, {0, 0.1, 4}), 0.0f);
    EXPECT_EQ(along(*stackOf({sheet(0.5f), clear}), {0, 0.1, 0}, {0, 0.1, 4}), 0.0f);
    EXPECT_EQ(along(*stackOf({sheet(0.5f), mirror()}), {0, 0.1, 0}, {0, 0.1, 4}), 0.0f);
    // Of glass that is half cut away, the share that is not there; beyond its face is glass, of
    // whose radiance 1 / 1.5^2 is seen from outside.
    clear.transparency = 0.25f;
    EXPECT_FLOAT_EQ(along(*stackOf({sheet(0.5f), clear}), {0, 0.1, 4}, {0, 0.1, 0}),
                    0.125f / 2.25f);
    EXPECT_FLOAT_EQ(along(*stackOf({sheet(0.5f), clear}), {0, 0.1, 0}, {0, 0.1, 4}),
                    0.125f * 2.25f);
}

TEST(Transmittance, OfRaysThatAreNone) {
    const auto scene = stackOf({sheet(0.5f)});
    const float nan = std::numeric_limits<float>::quiet_NaN();
    EXPECT_EQ(scene->transmittance({{nan, 0, 0}, {0, 0, 1}}).g, 0.0f);
    EXPECT_EQ(scene->transmittance({{0, 0, 0}, {0, nan, 1}}).g, 0.0f);
}

// More than are kept without memory of their own, and in an order that is not that of the scene.
TEST(Transmittance, OfManySheets) {
    std::vector<MaterialDescription> many(100, sheet(0.99f));
    float product = 1.0f;
    for (int i = 0; i < 100; ++i) product *= 0.99f;
    EXPECT_EQ(along(*stackOf(many), {0.3, 0.1, 0}, {0.3, 0.1, 101}), product);
}

TEST(Transmittance, BothRootsOfASphere) {
    SceneMaker maker;
    maker.sphere({0, 0, 2}, 1, maker.material(sheet(0.5f)));
    maker.quad({-4, -4, -1}, {8, 0, 0}, {0, 8, 0}, maker.diffuse(Rgb(0.5f)));
    const auto scene = maker.build();
    EXPECT_EQ(along(*scene, {0.2, 0.1, 0}, {0.2, 0.1, 4}), 0.25f);
    EXPECT_EQ(along(*scene, {0.2, 0.1, 2}, {0.2, 0.1, 4}), 0.5f);
    EXPECT_EQ(along(*scene, {0.2, 0.1, 0}, {0.2, 0.1, 2}), 0.5f);
    EXPECT_EQ(along(*scene, {2, 0, 0}, {2, 0, 4}), 1.0f);
}

// A ray through an edge or a corner meets several triangles of one sheet in one place.
TEST(Transmittance, NeighboursCountOnce) {
    SceneMaker maker;
    maker.quad({-1, -1, 1}, {2, 0, 0}, {0, 2, 0}, maker.material(sheet(0.5f)), 8);
    const auto scene = maker.build();
    for (int i = -3; i <= 3; ++i)
        for (int j = -3; j <= 3; ++j) {
            const double x = 0.25 * i, y = 0.25 * j;
            EXPECT_EQ(along(*scene, {x, y, 0}, {x, y, 2}), 0.5f) << x << ' ' << y;
            EXPECT_EQ(along(*scene, {x + 0.125, y + 0.125, 0}, {x + 0.125, y + 0.125, 2}), 0.5f);
        }
}

// Faces in one place count as one, as they do for paths, which meet the first.
TEST(Transmittance, FacesInOnePlaceCountOnce) {
    SceneMaker maker;
    for (int i = 0; i < 2; ++i)
        maker.quad({-1, -1, 1}, {2, 0, 0.3}, {0, 2, 0.2}, maker.material(sheet(0.5f)));
    const auto scene = maker.build();
    EXPECT_EQ(along(*scene, {0.31, 0.17, 0}, {0.31, 0.17, 3}), 0.5f);
}

std::shared_ptr<const SkyPicture> chequers(std::uint32_t across) {
    return std::make_shared<const SkyPicture>(across, across, [](std::uint32_t x, std::uint32_t y) {
        return Rgb((x + y) % 2 == 0 ? 1.0f : 0.0f);
    });
}

// A square [-1, 1]^2 at z = height with texture coordinates from 0 to 1.
void addCutOut(SceneMaker& maker, double height, std::uint32_t material) {
    maker.quad({-1, -1, height}, {2, 0, 0}, {0, 2, 0}, material);
    const auto& last =
        std::get<std::shared_ptr<const TriangleMesh>>(maker.description.instances.back().shape);
    TriangleMesh mesh = *last;
    for (const Vec3f& p : mesh.positions)
        mesh.texcoords.push_back({0.5f * p.x + 0.5f, 0.5f * p.y + 0.5f});
    mesh.texcoordIndices = mesh.triangles;
    maker.description.instances.back().shape = std::make_shared<const TriangleMesh>(mesh);
}

TEST(Transmittance, GoesByTheTexel) {
    SceneMaker maker;
    maker.description.textures = chequers(4);
    MaterialDescription leaf;
    leaf.diffuse = Rgb(0.5f);
    leaf.opacityTexture = 0;
    addCutOut(maker, 1, maker.material(leaf));
    maker.quad({-1, -1, 3}, {2, 0, 0}, {0, 2, 0}, maker.diffuse(Rgb(0.5f)));
    const auto scene = maker.build();
    // Middles of texels of half a unit.
    EXPECT_EQ(along(*scene, {-0.75, -0.75, 0}, {-0.75, -0.75, 2}), 0.0f);
    EXPECT_EQ(along(*scene, {-0.25, -0.75, 0}, {-0.25, -0.75, 2}), 1.0f);
    // Between two of them the opacity is half.
    EXPECT_NEAR(along(*scene, {-0.5, -0.75, 0}, {-0.5, -0.75, 2}), 0.5f, 1e-6f);
}

TEST(Transmittance, CutOutsCastNoCaustics) {
    MaterialDescription leaf = sheet(0.0f, 0.5f);
    leaf.opacityTexture = 0;
    EXPECT_FALSE(castsCaustics(leaf));
    EXPECT_FALSE(castsCaustics(sheet(0.5f, 0.5f)));
    leaf.glossy = Rgb(0.2f);
    leaf.glossyExponent = 500;
    EXPECT_TRUE(castsCaustics(leaf));
    MaterialDescription pane = glass();
    pane.transparency = 0.5f;
    EXPECT_TRUE(castsCaustics(pane));
}

TEST(Transmittance, GoingStraightIsNoEventOfAPath) {
    PathState state;
    state.scatter(Lobe::kStraight, false);
    EXPECT_EQ(state.classify(), PathClass::kEmission);
    state.scatter(Lobe::kDiffuse, false);
    state.scatter(Lobe::kStraight, false);
    EXPECT_EQ(state.classify(), PathClass::kDirect);
    state.scatter(Lobe::kReflection, false);
    state.scatter(Lobe::kStraight, false);
    EXPECT_EQ(state.classify(), PathClass::kCaustic);
}

// What is cut away keeps its share, however bright the rest is.
TEST(Transmittance, IsWhatTheBsdfLetsThrough) {
    MaterialDescription bright = sheet(0.25f, 0.9f);
    bright.glossy = Rgb(0.9f);
    bright.glossyExponent = 20;
    const auto scene = stackOf({bright});
    Surface surface;
    ASSERT_TRUE(scene->intersect({Vec3f{0.1f, 0.2f, -1.0f}, {0, 0, 1}}, surface));
    const Bsdf bsdf(scene->materials(), surface, {0, 0, -1}, Transport::kRadiance, Rgb(1.0f));
    EXPECT_EQ(bsdf.reflectance(Lobe::kStraight).g, 0.25f);
    EXPECT_NEAR(bsdf.albedo().g, 1.0f, 1e-6f);
    EXPECT_EQ(along(*scene, Vec3d{0.1, 0.2, -1}, Vec3d{0.1, 0.2, 3}), 0.25f);
}

enum class Lamp { kPoint, kSun, kArea, kSphere, kSky };

// A floor, lit through a sheet, or without one.
SceneMaker litFloor(Lamp lamp, float transparency, float reflectance, bool withSheet) {
    SceneMaker maker;
    maker.quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, maker.diffuse(Rgb(0.5f)));
    if (withSheet)
        maker.quad({-20, -20, 1}, {40, 0, 0}, {0, 40, 0},
                   maker.material(sheet(transparency, reflectance)));
    if (lamp == Lamp::kPoint) maker.pointLight({0.3, 0.2, 2}, Rgb(5.0f));
    if (lamp == Lamp::kSun) maker.sun({0.2, 0.1, -1}, Rgb(3.0f), 0);
    if (lamp == Lamp::kArea)
        maker.quad({-1, -1, 2}, {0, 2, 0}, {2, 0, 0}, maker.diffuse({}, Rgb(3.0f)));
    if (lamp == Lamp::kSphere) maker.sphere({0, 0.5, 2}, 0.5, maker.diffuse({}, Rgb(3.0f)));
    if (lamp == Lamp::kSky) maker.sky(Rgb(1.0f));
    maker.camera({0, -0.9, 0.5}, {0, 0, 0}, {0, 0, 1}, 40);
    return maker;
}

// Direct light under a half-transparent sheet is half, its caustic light none, by both integrators.
TEST(Transmittance, HalfTheDirectLightUnderASheet) {
    for (const IntegratorKind integrator : {IntegratorKind::kPhoton, IntegratorKind::kPath})
        for (const Lamp lamp : {Lamp::kPoint, Lamp::kSun, Lamp::kArea, Lamp::kSphere, Lamp::kSky}) {
            const auto render = [&](bool withSheet) {
                return measure(litFloor(lamp, 0.5f, 0.0f, withSheet).build(),
                               smallFrame(16, 16, integrator, 16, 2));
            };
            const MeasuredLayers open = render(false), under = render(true);
            Measured half = open.direct;
            for (std::size_t i = 0; i < 3; ++i) {
                half.mean[i] *= 0.5;
                half.standardError[i] *= 0.5;
            }
            ASSERT_GT(half.mean[0], 0.0);
            EXPECT_TRUE(agree(under.direct, half, 1e-5))
                << static_cast<int>(integrator) << ' ' << static_cast<int>(lamp);
            EXPECT_EQ(under.caustic.mean[0], 0.0);
            EXPECT_NEAR(under.indirect.mean[0], 0.0, 1e-9);
        }
}

// With a sheet that reflects as well: light goes to and fro below it.
TEST(Transmittance, PhotonsAndPathsAgreeUnderASheet) {
    for (const Lamp lamp : {Lamp::kPoint, Lamp::kArea, Lamp::kSky}) {
        const auto scene = litFloor(lamp, 0.5f, 0.7f, true).build();
        const MeasuredLayers photon =
            measure(scene, smallFrame(16, 16, IntegratorKind::kPhoton, 8, 2));
        const MeasuredLayers path =
            measure(scene, smallFrame(16, 16, IntegratorKind::kPath, 16, 3));
        EXPECT_TRUE(agree(photon.direct, path.direct, 1e-4)) << static_cast<int>(lamp);
        EXPECT_TRUE(agree(photon.indirect, path.indirect, 0.02)) << static_cast<int>(lamp);
        EXPECT_EQ(photon.caustic.mean[0], 0.0);
        EXPECT_EQ(path.caustic.mean[0], 0.0);
    }
}

// A cut-out's shadow is direct light's: sharp, and no photon is spent on it.
TEST(Transmittance, ACutOutHasASharpShadow) {
    SceneMaker maker;
    // Opaque about x = -0.5, cut away about x = 0.5, half of it at 0.
    maker.description.textures = std::make_shared<const SkyPicture>(
        4, 1, [](std::uint32_t x, std::uint32_t) { return Rgb(x < 2 ? 1.0f : 0.0f); });
    MaterialDescription leaf = sheet(0.0f, 0.5f);
    leaf.opacityTexture = 0;
    maker.quad({-2, -2, 0}, {4, 0, 0}, {0, 4, 0}, maker.diffuse(Rgb(0.5f)));
    addCutOut(maker, 1, maker.material(leaf));
    maker.sun({0, 0, -1}, Rgb(2.0f), 0);
    maker.camera({0, 0, 0.9}, {0, 0, 0}, {0, 1, 0}, 90);
    const auto scene = maker.build();
    const RenderSettings settings = smallFrame(32, 32, IntegratorKind::kPhoton, 4, 2);
    const Plan plan = makePlan(*scene, settings);
    EXPECT_FALSE(plan.causticMap);
    const auto regions = measureRegions(scene, settings, {0, 0, 32, 32},
                                        {{6, 0, 8, 32}, {14, 0, 18, 32}, {24, 0, 26, 32}});
    const double open = 0.5 * 2 / std::numbers::pi;
    EXPECT_EQ(regions[0].direct.mean[0], 0.0);
    EXPECT_NEAR(regions[1].direct.mean[0], 0.5 * open, 0.01 * open);
    EXPECT_NEAR(regions[2].direct.mean[0], open, 1e-5);
}

// Seen through a texel that is cut away, a surface's albedo is what lies behind.
TEST(Transmittance, TheAlbedoLayerLooksThrough) {
    SceneMaker maker;
    maker.quad({-1, -1, 1}, {2, 0, 0}, {0, 2, 0}, maker.material(sheet(1.0f)));
    maker.quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, maker.diffuse(Rgb(0.25f)));
    const auto scene = maker.build();
    SampleRadiance first;
    Ray ray{Vec3f{0.1f, 0.2f, 1.0f}, {0, 0, -1}};
    Surface surface;
    while (scene->intersect(ray, surface)) {
        const Bsdf bsdf(scene->materials(), surface, -ray.direction, Transport::kRadiance,
                        Rgb(1.0f));
        recordFirstHit(surface, bsdf, first);
        ray = rayFrom(surface, ray.direction);
    }
    EXPECT_EQ(first.albedo.g, 0.25f);
    EXPECT_EQ(first.coverage, 1.0f);
}

}  // namespace
}  // namespace pm::test
