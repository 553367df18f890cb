// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Shares of discs at edges and corners against their closed forms.
#include "integrator/photons/estimate/surface_patch.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include "integrator/photons/estimate/surface_patches.h"
#include "integrator/sampling/warps.h"
#include "tests/support/scene_maker.h"
#include "tests/support/statistics.h"

namespace pm::test {
namespace {

constexpr float kRadius = 0.05f;

// Of a disc of radius 1 the part within a straight edge at a distance from its middle.
double shareAtEdge(double away) {
    const double segment = std::acos(away) - away * std::sqrt(1 - away * away);
    return 1 - segment / std::numbers::pi;
}

// A plate's edge along the axes of the grid, where roundings that were the same in all squares
// would add up: within 5 % everywhere, as at all edges, and less than 1 % off in the mean.
TEST(SurfacePatch, SharesAtEdgesAlongTheGrid) {
    SceneMaker maker;
    maker.quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, maker.diffuse(Rgb(0.5f)));
    const auto scene = maker.build();
    Random random(3);
    double sum = 0, worst = 0;
    int count = 0;
    for (int i = 0; i < 400; ++i) {
        const float above = random.next() * 0.75f, along = random.next() * 1.5f - 0.75f;
        const Vec3f site{0.3f * random.next(), -1.0f + above * kRadius, 0};
        const SurfacePatch patch(*scene, site, {0, 0, 1}, kRadius, static_cast<std::uint64_t>(i));
        ASSERT_FALSE(patch.isWhole());
        const float radius = 0.5f + 0.5f * random.next(), away = radius * random.next();
        if (std::abs(away - above) > 0.75f) continue;
        const Vec3f middle{site.x + along * kRadius, -1.0f + away * kRadius, 0};
        ASSERT_TRUE(patch.speaksFor(*scene, middle, {0, 0, 1}, radius * kRadius));
        const auto shares = patch.shares(middle, radius * kRadius);
        const double error =
            static_cast<double>(shares.wide) / shareAtEdge(static_cast<double>(away / radius)) - 1;
        sum += error;
        worst = std::max(worst, std::abs(error));
        ++count;
    }
    fmt::print("    mean error {:+.4f}, worst {:.3f}\n", sum / count, worst);
    EXPECT_GT(count, 200);
    EXPECT_LT(std::abs(sum / count), 0.01);
    EXPECT_LT(worst, 0.05);
}

// A flat shape somewhere in space, at an angle to all axes: in a plane of its own, in radii.
struct Shape {
    struct Part {  // a rectangle
        double x, y, width, height;
    };
    std::vector<Part> parts;

    bool holds(double x, double y) const {
        return std::ranges::any_of(parts, [&](const Part& p) {
            return x >= p.x && x < p.x + p.width && y >= p.y && y < p.y + p.height;
        });
    }
    // Of a disc of radius 1.
    double share(double x, double y) const {
        constexpr int kPoints = 4096;
        int inside = 0;
        for (int i = 0; i < kPoints; ++i) {
            const double r = std::sqrt((i + 0.5) / kPoints), phi = 2.399963229728653 * i;
            inside += holds(x + r * std::cos(phi), y + r * std::sin(phi));
        }
        return static_cast<double>(inside) / kPoints;
    }
};

// What patches of the cells say of discs on a shape, over what is so, less 1.
struct Errors {
    int count = 0, wrong = 0;  // by more than 10 %
    double sum = 0, worst = 0;

    double mean() const { return sum / count; }
    double wrongShare() const { return static_cast<double>(wrong) / count; }
};

// place: of a disc's middle on the shape. patchRadius: of the largest discs, in those of these.
Errors errorsOn(const Shape& shape, double patchRadius,
                const std::function<Vec2f(Random&)>& place) {
    Errors errors;
    Random random(7);
    for (int turn = 0; turn < 30; ++turn) {
        const Frame frame(sampleUniformSphere(random.next2D()));
        const float spin = random.next();
        const SinCos phi = sinCosTurns(spin);
        const Vec3d a = Vec3d(frame.tangent * phi.cos + frame.bitangent * phi.sin) * kRadius;
        const Vec3d b = Vec3d(frame.bitangent * phi.cos - frame.tangent * phi.sin) * kRadius;
        SceneMaker maker;
        const auto grey = maker.diffuse(Rgb(0.5f));
        for (const Shape::Part& part : shape.parts)
            maker.quad(a * part.x + b * part.y, a * part.width, b * part.height, grey);
        const auto scene = maker.build();
        const SurfacePatches patches(*scene, static_cast<float>(patchRadius) * kRadius);
        for (int i = 0; i < 60; ++i) {
            const Vec2f at = place(random);
            const Vec3f position(a * static_cast<double>(at.x) + b * static_cast<double>(at.y) -
                                 scene->centre());
            SurfacePatch spare;
            const SurfacePatch& patch = patches.at(position, frame.normal, kRadius, spare);
            if (!patch.speaksFor(*scene, position, frame.normal, kRadius)) continue;
            const double truth = shape.share(static_cast<double>(at.x), static_cast<double>(at.y));
            const double error =
                static_cast<double>(patch.shares(position, kRadius).wide) / truth - 1;
            errors.sum += error;
            errors.worst = std::max(errors.worst, std::abs(error));
            errors.wrong += std::abs(error) > 0.1;
            ++errors.count;
        }
    }
    fmt::print(
        "    {} discs, mean error {:+.4f}, {:.3f} of them more than 10 % off, worst {:.2f}\n",
        errors.count, errors.mean(), errors.wrongShare(), errors.worst);
    return errors;
}

TEST(SurfacePatches, SharesAtTurnedEdges) {
    const Shape plate{{{-20, 0, 40, 20}}};
    for (const double patchRadius : {1.0, 1.02, 1.5, 1.98}) {
        SCOPED_TRACE(patchRadius);
        const Errors errors = errorsOn(plate, patchRadius, [](Random& random) {
            const Vec2f u = random.next2D();
            return Vec2f{20 * u.x - 10, u.y};
        });
        EXPECT_GT(errors.count, 1200);
        EXPECT_LT(std::abs(errors.mean()), 0.01);
        EXPECT_LT(errors.wrongShare(), 0.002);
        EXPECT_LT(errors.worst, 0.15);
    }
}

TEST(SurfacePatches, SharesAtTurnedCorners) {
    const Shape plate{{{0, 0, 20, 20}}};
    for (const double patchRadius : {1.0, 1.5}) {
        SCOPED_TRACE(patchRadius);
        const Errors errors =
            errorsOn(plate, patchRadius, [](Random& random) { return random.next2D(); });
        EXPECT_GT(errors.count, 600);
        EXPECT_LT(std::abs(errors.mean()), 0.02);
        EXPECT_LT(errors.wrongShare(), 0.005);
        EXPECT_LT(errors.worst, 0.2);
    }
}

// A hole as wide as a disc's radius.
TEST(SurfacePatches, HolesAreFound) {
    constexpr double kSide = 1.0;
    const Shape plane{
        {{-20, -20, 40, 20}, {-20, kSide, 40, 20}, {-20, 0, 20, kSide}, {kSide, 0, 20, kSide}}};
    const Errors errors = errorsOn(plane, 1.0, [](Random& random) {
        const Vec2f u = random.next2D();
        return Vec2f{-0.02f - 0.3f * u.x, u.y};
    });
    EXPECT_GT(errors.count, 600);
    EXPECT_LT(std::abs(errors.mean()), 0.02);
    EXPECT_LT(errors.wrongShare(), 0.002);
}

bool takesAsWhole(const Scene& scene, const Vec3f& site) {
    const Vec3f up{0, 0, 1};
    const SurfacePatch patch(scene, site, up, kRadius, 1);
    return patch.speaksFor(scene, site, up, kRadius) && patch.isWhole();
}

// Beside a fold of 16 degrees photons beyond it don't count: a disc there is not whole.
TEST(SurfacePatch, AFoldIsNotWhole) {
    const double bend = 16 * std::numbers::pi / 180;
    SceneMaker maker;
    const auto grey = maker.diffuse(Rgb(0.5f));
    maker.quad({-1, -1, 0}, {1, 0, 0}, {0, 2, 0}, grey);
    maker.quad({0, -1, 0}, {std::cos(bend), 0, std::sin(bend)}, {0, 2, 0}, grey);
    const auto scene = maker.build();
    const Vec3d origin = -scene->centre();
    for (const double away : {0.1, 0.5, 1.0, 1.5}) {
        const Vec3f site(origin + Vec3d(-away, 0, 0) * static_cast<double>(kRadius));
        EXPECT_FALSE(takesAsWhole(*scene, site)) << away;
    }
    const Vec3f site(origin + Vec3d(-2.1, 0, 0) * static_cast<double>(kRadius));
    EXPECT_TRUE(takesAsWhole(*scene, site));
}

// A ball bends as well, but everywhere alike.
TEST(SurfacePatch, ABallIsWhole) {
    SceneMaker maker;
    maker.sphere({0, 0, 0}, 20 * static_cast<double>(kRadius), maker.diffuse(Rgb(0.5f)));
    const auto scene = maker.build();
    EXPECT_TRUE(takesAsWhole(*scene, {0, 0, 20 * kRadius}));
}

// Far out on a ground 500,000 times as large as a disc places are rounded by more than a share of
// the disc that is otherwise enough to lift a photon off it: it would hide itself.
TEST(SurfacePatch, PhotonsCountOnAHugeGround) {
    const Frame frame(normalize(Vec3f{0.3f, -0.5f, 0.8f}));
    const Vec3d a(frame.tangent), b(frame.bitangent);
    SceneMaker maker;
    const auto grey = maker.diffuse(Rgb(0.5f));
    constexpr double kHalf = 20'000;
    const Vec3d foot = a * 18000.0;  // of a wall
    maker.quad((a + b) * -kHalf, a * (2 * kHalf), b * (2 * kHalf), grey);
    maker.quad(foot - b, b * 2.0, Vec3d(frame.normal), grey);
    const auto scene = maker.build();
    const Vec3d origin = foot - scene->centre();
    // Corners are floats: the ground lies where they say.
    const auto onGround = [&](const Vec3d& p) {
        Surface surface;
        EXPECT_TRUE(
            scene->intersect({Vec3f(p + Vec3d(frame.normal) * 0.5), -frame.normal}, surface));
        return surface.position;
    };
    Random random(11);
    int counted = 0;
    constexpr int kPhotons = 2000;
    for (int i = 0; i < kPhotons; ++i) {
        const Vec3d along = b * (static_cast<double>(random.next()) - 0.5);
        const double away = static_cast<double>(kRadius);
        const Vec3f site = onGround(origin + along + a * (0.3 * away));
        const SurfacePatch patch(*scene, site, frame.normal, kRadius, 1);
        ASSERT_TRUE(patch.speaksFor(*scene, site, frame.normal, kRadius));
        ASSERT_TRUE(patch.hidesSurface());
        const double x = 0.05 + 0.9 * static_cast<double>(random.next());
        const Vec3f place = onGround(origin + along + a * (x * away));
        counted += patch.counts(*scene, {place, Rgb(1.0f), PackedNormal(frame.normal)});
    }
    EXPECT_EQ(counted, kPhotons);
}

}  // namespace
}  // namespace pm::test
