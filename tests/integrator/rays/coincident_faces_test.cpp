// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Faces that lie on others: which one rays meet is a rule.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <vector>

#include "integrator/materials/bsdf.h"
#include "integrator/scene/scene.h"
#include "integrator/transport/path/direct_light.h"
#include "tests/support/scene_maker.h"
#include "tests/support/sky_picture.h"
#include "tests/support/statistics.h"

namespace pm::test {
namespace {

constexpr int kRays = 20'000;

// A plane that lies anyhow, and two directions in it.
struct Frame3 {
    Vec3d origin, x, y, up;
};

// Along the axes, and turned.
std::vector<Frame3> frames() {
    const auto turned = [](Vec3d origin, double a, double b) {
        const Vec3d x{std::cos(a), std::sin(a) * std::cos(b), std::sin(a) * std::sin(b)};
        const Vec3d y{-std::sin(a), std::cos(a) * std::cos(b), std::cos(a) * std::sin(b)};
        return Frame3{origin, x, y, cross(x, y)};
    };
    return {turned({0, 0, 0}, 0, 0), turned({0.3, -0.2, 0.1}, 0, 0), turned({0, 0, 0}, 0.7, 1.1),
            turned({3, 50, -20}, 0.3, 2.5)};
}

// Adds a square around the origin's foot, facing up or down.
void square(SceneMaker& maker, const Frame3& in, double half, bool up, std::uint32_t material,
            std::uint32_t divisions = 1) {
    const Vec3d corner = in.origin - (in.x + in.y) * half;
    const Vec3d x = in.x * (2 * half), y = in.y * (2 * half);
    maker.quad(corner, up ? x : y, up ? y : x, material, divisions);
}

// Calls visit(surface, distance from the middle) for rays from the one side; the middle's square
// has its edges at 0.5.
template <typename Visit>
void shoot(const Scene& scene, const Frame3& at, double side, const Visit& visit) {
    Random random(7);
    for (int i = 0; i < kRays; ++i) {
        const auto signedValue = [&] { return 2.0 * static_cast<double>(random.next()) - 1; };
        const double x = signedValue(), y = signedValue();
        const Vec3d end = at.origin + at.x * x + at.y * y - scene.centre();
        const Vec3d start = end + at.x * signedValue() * 2.0 + at.y * signedValue() * 2.0 +
                            at.up * (side * (0.05 + static_cast<double>(random.next())));
        Surface surface;
        ASSERT_TRUE(scene.intersect({Vec3f(start), Vec3f(end - start)}, surface));
        visit(surface, std::max(std::abs(x), std::abs(y)));
    }
}

TEST(CoincidentFaces, ALampInTheCeilingIsMetAsTheLamp) {
    for (const Frame3& at : frames())
        for (const std::uint32_t divisions : {1u, 7u})
            for (const bool lampFirst : {false, true}) {
                SceneMaker maker;
                const auto white = maker.diffuse(Rgb(0.7f));
                const auto lamp = maker.diffuse({}, Rgb(1.0f));
                if (lampFirst) square(maker, at, 0.5, false, lamp, divisions);
                square(maker, at, 2, false, white);
                if (!lampFirst) square(maker, at, 0.5, false, lamp, divisions);
                const auto scene = maker.build();
                int wrong = 0;
                shoot(*scene, at, -1, [&](const Surface& surface, double from) {
                    if (std::abs(from - 0.5) < 1e-4) return;
                    wrong += (surface.light != kNoLight) != (from < 0.5);
                });
                EXPECT_EQ(0, wrong) << "of " << kRays << ", " << at.origin.x << " " << divisions;
            }
}

// A floor with a square of another material on it, facing up or down, the one or the other first in
// the scene: from both sides all rays meet the floor. Calls visit(scene).
template <typename Visit>
void expectFloorIsMet(const MaterialDescription& onTop, bool facesUp, const Visit& visit) {
    for (const Frame3& at : frames())
        for (const bool floorFirst : {true, false}) {
            SceneMaker maker;
            const auto white = maker.diffuse(Rgb(0.7f));
            const auto other = maker.material(onTop);
            if (!floorFirst) square(maker, at, 0.5, facesUp, other, 3);
            square(maker, at, 2, true, white, 2);
            if (floorFirst) square(maker, at, 0.5, facesUp, other, 3);
            const auto scene = maker.build();
            int wrong = 0;
            for (const double side : {1.0, -1.0})
                shoot(*scene, at, side,
                      [&](const Surface& surface, double) { wrong += surface.material != white; });
            EXPECT_EQ(0, wrong) << "of " << 2 * kRays << ", " << at.origin.x << " " << floorFirst;
            visit(*scene);
        }
}

TEST(CoincidentFaces, GlassOnAFloorIsMetAsTheFloor) {
    MaterialDescription glass;
    glass.kind = MaterialKind::kDielectric;
    expectFloorIsMet(glass, false, [](const Scene&) {});
}

TEST(CoincidentFaces, ASheetOnAFloorIsMetAsTheFloor) {
    MaterialDescription sheet;
    sheet.diffuse = Rgb(0.3f);
    sheet.transparency = 0.9f;
    expectFloorIsMet(sheet, true, [](const Scene& scene) {
        EXPECT_TRUE(std::ranges::any_of(scene.notices(), [](const Notice& notice) {
            return notice.text.starts_with("18 half-transparent triangles lie on others");
        }));
    });
}

// Where blocks of leaves touch, two faces are cut by the same picture: what one lets through the
// other would too. Of unlike ones, and of evenly half-transparent ones, one is missed.
TEST(CoincidentFaces, SheetsCutAlikeAreNoFault) {
    const auto notices = [](const MaterialDescription& one, const MaterialDescription& other) {
        std::size_t count = 0;
        for (const Frame3& at : frames()) {
            SceneMaker maker;
            const auto first = maker.material(one);
            square(maker, at, 2, true, first);
            square(maker, at, 2, false, &one == &other ? first : maker.material(other));
            maker.description.textures = std::make_shared<const SkyPicture>(
                4, 2, [](std::uint32_t, std::uint32_t) { return Rgb(0.0f); });
            maker.pointLight({0, 0, 100}, Rgb(1.0f));
            count += maker.build()->notices().size();
        }
        return count;
    };
    MaterialDescription leaves, decal, veil;
    leaves.diffuse = decal.diffuse = veil.diffuse = Rgb(0.5f);
    leaves.opacityTexture = decal.opacityTexture = 0;
    veil.transparency = 0.5f;
    EXPECT_EQ(notices(leaves, leaves), 0u);
    EXPECT_EQ(notices(leaves, decal), frames().size());
    EXPECT_EQ(notices(veil, veil), frames().size());
}

// What is wholly cut away is not what a pixel shows; what is there in part is.
TEST(FirstHits, PassOverWhatIsCutAway) {
    for (const float opacity : {0.0f, 0.5f, 1.0f}) {
        SceneMaker maker;
        MaterialDescription sheet;
        sheet.diffuse = Rgb(0.25f);
        sheet.opacityTexture = 0;
        const auto above = maker.material(sheet), below = maker.diffuse(Rgb(0.75f));
        maker.quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, below);
        maker.quad({-1, -1, 1}, {2, 0, 0}, {0, 2, 0}, above);
        maker.description.textures = std::make_shared<const SkyPicture>(
            4, 2, [&](std::uint32_t, std::uint32_t) { return Rgb(opacity); });
        const auto scene = maker.build();
        SampleRadiance result;
        for (Ray ray{{0.1f, 0.2f, 3.0f}, {0, 0, -1}};;) {
            Surface surface;
            if (!scene->intersect(ray, surface)) break;
            recordFirstHit(
                surface,
                Bsdf(scene->materials(), surface, {0, 0, 1}, Transport::kRadiance, Rgb(1.0f)),
                result);
            ray = rayFrom(surface, ray.direction);
        }
        EXPECT_EQ(result.coverage, 1);
        EXPECT_EQ(result.firstMaterial, opacity > 0 ? above : below);
        EXPECT_NEAR(result.albedo.r, opacity > 0 ? 1 - opacity * 0.75f : 0.75f, 1e-6);
    }
}

// Two faces as one lamp that shines both ways.
TEST(CoincidentFaces, LampsBackToBackShineBothWays) {
    for (const Frame3& at : frames()) {
        SceneMaker maker;
        const auto lamp = maker.diffuse({}, Rgb(1.0f));
        square(maker, at, 2, true, lamp);
        square(maker, at, 2, false, lamp);
        const auto scene = maker.build();
        EXPECT_TRUE(scene->notices().empty());
        for (const double side : {1.0, -1.0}) {
            int dark = 0;
            shoot(*scene, at, side, [&](const Surface& surface, double) {
                dark += side * dot(Vec3d(surface.geometricNormal), at.up) < 0.0;
            });
            EXPECT_EQ(0, dark);
        }
    }
}

// A huge ground is intersected in double, and so is what lies on it beside it.
TEST(CoincidentFaces, OnAHugeGround) {
    SceneMaker maker;
    const auto white = maker.diffuse(Rgb(0.7f)), lamp = maker.diffuse({}, Rgb(1.0f));
    maker.quad({-9e4, 0, 9e4}, {1.8e5, 0, 0}, {0, 0, -1.8e5}, white);
    maker.quad({-0.5, 0, 0.5}, {1, 0, 0}, {0, 0, -1}, lamp);
    maker.box({4, 0.1, 4}, {5, 1, 5}, white, false);
    const auto scene = maker.build();
    const Frame3 at{{0, 0, 0}, {1, 0, 0}, {0, 0, -1}, {0, 1, 0}};
    int wrong = 0;
    shoot(*scene, at, 1, [&](const Surface& surface, double from) {
        if (std::abs(from - 0.5) < 1e-3) return;
        wrong += (surface.light != kNoLight) != (from < 0.5);
    });
    EXPECT_EQ(0, wrong);
}

TEST(CoincidentFaces, SayWhatNoRuleHelps) {
    const Frame3 at = frames()[2];
    for (const bool isGlass : {false, true}) {
        SceneMaker maker;
        MaterialDescription description;
        if (isGlass)
            description.kind = MaterialKind::kDielectric;
        else
            description.emission = Rgb(1.0f);
        const auto material = maker.material(description);
        square(maker, at, 1, true, material);
        square(maker, at, 1, !isGlass, isGlass ? material : maker.material(description));
        maker.pointLight({0, 9, 0}, Rgb(1.0f));
        const auto scene = maker.build();
        // Of glass it is told, too, that the squares are open.
        ASSERT_EQ(isGlass ? 2u : 1u, scene->notices().size());
        EXPECT_EQ(NoticeCode::kDegenerateGeometry, scene->notices().back().code);
        EXPECT_TRUE(scene->notices().back().text.starts_with("4 triangles"))
            << scene->notices().back().text;
    }
}

// A lamp's neighbours in its plane, and what is a little above it, are met where they are.
TEST(CoincidentFaces, NeighboursAreNotAmongThem) {
    for (const Frame3& at : frames()) {
        SceneMaker maker;
        const auto white = maker.diffuse(Rgb(0.7f)), lamp = maker.diffuse({}, Rgb(1.0f));
        square(maker, at, 0.5, true, lamp, 5);
        maker.quad(at.origin + at.x * 0.5 - at.y * 0.5, at.x, at.y, white);
        square(maker, {at.origin - at.up, at.x, at.y, at.up}, 3, true, white);
        for (const double height : {1e-4, 2e-5}) {
            square(maker, {at.origin + at.up * height, at.x, at.y, at.up}, 3, false, white);
            const auto scene = maker.build();
            int shining = 0;
            shoot(*scene, at, 1,
                  [&](const Surface& surface, double) { shining += surface.light != kNoLight; });
            EXPECT_EQ(0, shining) << height;
        }
    }
}

}  // namespace
}  // namespace pm::test
