// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Bodies of glass, water and air in and on each other, against closed forms of stacks of slabs.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "tests/support/scene_maker.h"

namespace pm::test {
namespace {

MaterialDescription medium(float ior, int priority = 0, float distance = 0.0f) {
    MaterialDescription m;
    m.kind = MaterialKind::kDielectric;
    m.name = fmt::format("index {}", ior);
    m.ior = ior;
    m.priority = priority;
    m.attenuationColour = {0.5f, 0.25f, 1.0f};
    m.attenuationDistance = distance;
    return m;
}

struct Layer {
    double ior;
    double left = 1;  // of light after one way through
};

// What a stack of slabs in vacuum lets through at normal incidence, all reflections between its
// boundaries added up, boundary by boundary.
double through(const std::vector<Layer>& layers) {
    double forth = 1, back = 0;  // of all so far: lets through; reflects what comes back
    double before = 1;
    const auto addBoundary = [&](double ior) {
        const double root = (ior - before) / (ior + before), r = root * root;
        const double loops = 1 / (1 - back * r);
        forth *= (1 - r) * loops;
        back = r + (1 - r) * (1 - r) * back * loops;
        before = ior;
    };
    for (const Layer& layer : layers) {
        addBoundary(layer.ior);
        forth *= layer.left;
        back *= layer.left * layer.left;
    }
    addBoundary(1);
    return forth;
}

// A lamp of radiance 1 seen through what is between z = 0 and 4, from above.
void addLampAndCamera(SceneMaker& maker) {
    maker.quad({-4, -4, -2}, {8, 0, 0}, {0, 8, 0}, maker.diffuse({}, Rgb(1.0f)));
    maker.camera({0, 0, 30}, {0, 0, 0}, {0, 1, 0}, 0.2);
}

Measured seen(const SceneMaker& maker, IntegratorKind integrator, std::uint32_t passes = 16) {
    RenderSettings settings = smallFrame(8, 8, integrator, passes, 5);
    settings.photons = 1000;
    return measure(maker.build(), settings).beauty;
}

constexpr IntegratorKind kIntegrators[] = {IntegratorKind::kPath, IntegratorKind::kPhoton};

void slab(SceneMaker& maker, double from, double to, std::uint32_t material, double half = 3) {
    maker.box({-half, -half, from}, {half, half, to}, material, false);
}

TEST(Media, TheClosedFormIsRight) {
    EXPECT_NEAR(through({{1.5}}), 0.96 * 0.96 / (1 - 0.04 * 0.04), 1e-12);
    EXPECT_NEAR(through({{1.5, 0.5}}), 0.460984, 1e-6);
    EXPECT_NEAR(through({{1.5}, {1}, {1.5}}), through({{1.5}, {1.0, 1.0}, {1.5}}), 1e-12);
    EXPECT_NEAR(through({{1.5}, {1.5}}), through({{1.5}}), 1e-12);
}

// Water in a vessel of glass, whose cavity is a wall of its own: touching it, reaching into it and
// with a gap the picture is the same.
TEST(Media, WaterInGlassIsTheSameHoweverItIsModelled) {
    const double right = through({{1.5}, {1.33}, {1.5}});
    EXPECT_GT(std::abs(right - through({{1.5}, {1}, {1.33}, {1}, {1.5}})), 0.05);
    for (const auto integrator : kIntegrators)
        for (const auto& [name, reach] :
             {std::pair{"touching", 0.0}, {"reaching in", 0.2}, {"with a gap", -1e-4}}) {
            SceneMaker maker;
            const auto glass = maker.material(medium(1.5f, 1)),
                       water = maker.material(medium(1.33f));
            slab(maker, 0, 4, glass);
            maker.box({-2, -2, 1}, {2, 2, 3}, glass, true);
            slab(maker, 1 - reach, 3 + reach, water, 2 + reach);
            addLampAndCamera(maker);
            const auto scene = maker.build();
            EXPECT_TRUE(scene->notices().empty()) << scene->notices()[0].text;
            EXPECT_TRUE(agrees(seen(maker, integrator), Rgb(static_cast<float>(right)), 1e-3))
                << name;
        }
}

// Of equal priorities what is smaller is there, so water is where it reaches into glass.
TEST(Media, WithoutPrioritiesTheSmallerBodyIsThere) {
    const double right = through({{1.5, std::pow(0.25, 0.8)}, {1.33}, {1.5, std::pow(0.25, 0.8)}});
    SceneMaker maker;
    const auto glass = maker.material(medium(1.5f, 0, 1.0f)), water = maker.material(medium(1.33f));
    slab(maker, 0, 4, glass);
    maker.box({-2, -2, 1}, {2, 2, 3}, glass, true);
    slab(maker, 0.8, 3.2, water, 2.2);
    addLampAndCamera(maker);
    for (const auto integrator : kIntegrators) {
        const Measured found = seen(maker, integrator);
        EXPECT_NEAR(found.mean[1], right, 4 * found.standardError[1] + 1e-3 * right);
    }
}

// Both end in one plane, above or below: the priority says which of them is there.
TEST(Media, FacesInOnePlaneAreOfTheHigherPriority) {
    for (const bool isFirst : {false, true})
        for (const double ends : {0.0, 4.0}) {
            SceneMaker maker;
            const auto glass = maker.material(medium(1.5f, isFirst ? 1 : 3, 1.0f)),
                       water = maker.material(medium(1.33f, 2));
            const auto addGlass = [&] { slab(maker, 0, 4, glass); };
            if (isFirst) addGlass();
            slab(maker, ends > 0 ? 2 : 0, ends > 0 ? 4 : 2, water, 2.2);
            if (!isFirst) addGlass();
            addLampAndCamera(maker);
            const double left = std::pow(0.25, isFirst ? 2 : 4);
            const double right = isFirst ? through({{1.5, left}, {1.33}}) : through({{1.5, left}});
            for (const auto integrator : kIntegrators)
                EXPECT_NEAR(seen(maker, integrator).mean[1], right, 3e-3 * right)
                    << isFirst << ends;
            const auto scene = maker.build();
            for (const Notice& notice : scene->notices())
                EXPECT_EQ(notice.text.find("lie on others"), std::string::npos) << notice.text;
        }
}

// Neither is said to be there.
TEST(Media, FacesInOnePlaneOfEqualPrioritiesAreTold) {
    SceneMaker maker;
    slab(maker, 0, 4, maker.material(medium(1.5f, 0, 1.0f)));
    slab(maker, 2, 4, maker.material(medium(1.33f)), 2.2);
    addLampAndCamera(maker);
    const auto scene = maker.build();
    bool isTold = false;
    for (const Notice& notice : scene->notices())
        isTold |= notice.text.find("of glass lie on others of glass") != std::string::npos;
    EXPECT_TRUE(isTold);
}

TEST(Media, BodiesOfOneMaterialThatOverlapAreOne) {
    SceneMaker maker;
    const auto glass = maker.material(medium(1.5f));
    slab(maker, 0, 2, glass);
    slab(maker, 1.5, 4, glass);
    addLampAndCamera(maker);
    for (const auto integrator : kIntegrators)
        EXPECT_TRUE(
            agrees(seen(maker, integrator), Rgb(static_cast<float>(through({{1.5}}))), 1e-3));
}

TEST(Media, AirInGlassIsABodyOfItsOwn) {
    SceneMaker maker;
    slab(maker, 0, 4, maker.material(medium(1.5f)));
    slab(maker, 1, 3, maker.material(medium(1.0f, 1)), 2);
    addLampAndCamera(maker);
    for (const auto integrator : kIntegrators)
        EXPECT_TRUE(agrees(seen(maker, integrator),
                           Rgb(static_cast<float>(through({{1.5}, {1}, {1.5}}))), 1e-3));
}

// Glass in air in glass: of equal priorities the smaller is there.
TEST(Media, GlassInAirInGlass) {
    SceneMaker maker;
    const auto glass = maker.material(medium(1.5f, 1)), air = maker.material(medium(1.0f, 1));
    maker.sphere({0, 0, 1}, 2, glass);
    maker.sphere({0, 0, 1}, 1.5, air);
    maker.sphere({0, 0, 1}, 1, glass);
    addLampAndCamera(maker);
    for (const auto integrator : kIntegrators)
        EXPECT_TRUE(agrees(seen(maker, integrator),
                           Rgb(static_cast<float>(through({{1.5}, {1}, {1.5}, {1}, {1.5}}))),
                           1e-3));
}

// What lies in water is seen through it, and so it is by a camera in the water; shadow rays lose
// what the water takes.
TEST(Media, WhatLiesInWaterIsSeenThroughIt) {
    const auto seenFrom = [](Vec3d eye, float distance, IntegratorKind integrator) {
        SceneMaker maker;
        slab(maker, 0, 3, maker.material(medium(1.33f, 0, distance)));
        maker.quad({-1, -1, 1}, {2, 0, 0}, {0, 2, 0}, maker.diffuse({}, Rgb(1.0f)));
        maker.camera(eye, {0, 0, 0}, {0, 1, 0}, 0.2);
        return seen(maker, integrator, 4);
    };
    for (const auto integrator : kIntegrators) {
        for (const double z : {30.0, 2.5}) {
            const double clear = seenFrom({0, 0, z}, 0, integrator).mean[1];
            const double left = seenFrom({0, 0, z}, 1, integrator).mean[1];
            EXPECT_NEAR(left / clear, std::pow(0.25, std::min(z, 3.0) - 1), 1e-4) << z;
        }
    }
    // A floor in the water, lit by a lamp in the water right above it.
    const auto lit = [](float distance, IntegratorKind integrator) {
        SceneMaker maker;
        slab(maker, 0, 3, maker.material(medium(1.33f, 0, distance)), 8);
        maker.quad({-7, -7, 0.5}, {14, 0, 0}, {0, 14, 0}, maker.diffuse(Rgb(0.5f)));
        maker.pointLight({0, 0, 2.5}, Rgb(4.0f));
        maker.camera({0, 0.01, 2.4}, {0, 0, 0.5}, {0, 1, 0}, 1);
        RenderSettings settings = smallFrame(4, 4, integrator, 4, 5);
        settings.photons = 1000;
        return measure(maker.build(), settings).direct.mean[1];
    };
    for (const auto integrator : kIntegrators)
        EXPECT_NEAR(lit(1, integrator) / lit(0, integrator), std::pow(0.25, 2.0 + 1.9), 1e-3);
}

// By photons: through water that touches its glass onto a floor.
TEST(Media, PhotonsGoThroughStacksAsRaysDo) {
    SceneMaker maker;
    const auto glass = maker.material(medium(1.5f)), water = maker.material(medium(1.33f, 0, 1.0f));
    maker.box({-1, 0.5, -1}, {1, 1, 1}, glass, false);
    maker.box({-1, 1, -1}, {1, 2, 1}, water, false);
    maker.quad({-1, 0, 1}, {2, 0, 0}, {0, 0, -2}, maker.diffuse(Rgb(0.5f)));
    maker.sun({0, -1, 0}, Rgb(2.0f), 0);
    maker.camera({0, 0.45, 0.01}, {0, 0, 0}, {0, 0, -1}, 60);
    RenderSettings settings = smallFrame(8, 8, IntegratorKind::kPhoton, 16, 3);
    settings.photons = 60'000;
    const Measured found = measure(maker.build(), settings, {2, 2, 6, 6}).caustic;
    const auto radiance = [](double left) {
        return static_cast<float>(0.5 / 3.14159265358979 * 2 * through({{1.5}, {1.33, left}}));
    };
    EXPECT_TRUE(agrees(found, {radiance(0.5), radiance(0.25), radiance(1)}, 0.02));
}

// An open sheet over what absorbs is told; so is a body that is turned inside out.
TEST(Media, OpenBodiesAreTold) {
    SceneMaker maker;
    const auto water = maker.material(medium(1.33f, 0, 1.0f));
    maker.quad({-1, -1, 1}, {2, 0, 0}, {0, 2, 0}, water);
    maker.box({-2, -2, 0}, {2, 2, 1.5}, maker.diffuse(Rgb(0.5f)), true);
    addLampAndCamera(maker);
    const auto scene = maker.build();
    ASSERT_EQ(scene->notices().size(), 1u);
    EXPECT_NE(scene->notices()[0].text.find("is open (4 edges)"), std::string::npos)
        << scene->notices()[0].text;
    SceneMaker turned;
    turned.box({-1, -1, 0}, {1, 1, 1}, turned.material(medium(1.33f, 0, 1.0f)), true);
    turned.sphere({0, 0, 0.5}, 0.2, turned.diffuse(Rgb(0.5f)));
    addLampAndCamera(turned);
    const auto other = turned.build();
    ASSERT_EQ(other->notices().size(), 1u);
    EXPECT_NE(other->notices()[0].text.find("inside out"), std::string::npos);
}

}  // namespace
}  // namespace pm::test
