// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Curved shapes that are met in their own space: spheres under any placement.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "integrator/shapes/curved_shape.h"
#include "integrator/values/error.h"
#include "tests/support/scene_maker.h"
#include "tests/support/statistics.h"

namespace pm::test {
namespace {

// Turned, sheared, mirrored, moved.
constexpr Transform kAskew = {1.5, 0.3, -0.2, 0.4, 0.1, -0.6, 0.4, -0.3, 0.2, 0.5, 1.1, 0.7};

CurvedShape placed(const SphereShape& sphere, const Transform& transform) {
    return {Shape(sphere), transform, Vec3d(0), false, "egg"};
}

SceneMaker egg(const Transform& transform, std::uint32_t material, SceneMaker maker) {
    maker.sphere({0.1, 0, -0.2}, 0.8, material);
    maker.description.instances.back().transform = transform;
    const Vec3d middle = transformPoint(transform, {0.1, 0, -0.2});
    maker.camera(middle + Vec3d{0, 0, 6}, middle, {0, 1, 0}, 40);
    return maker;
}

// A point of the surface goes to one of the sphere, and the normal is across both its tangents.
TEST(Ellipsoid, IsMetWhereItsEquationSays) {
    const SphereShape sphere{{0.1, 0, -0.2}, 0.8};
    const CurvedShape shape = placed(sphere, kAskew);
    Random random(1);
    int met = 0;
    for (int i = 0; i < 2000; ++i) {
        const Vec3d from = Vec3d(sampleUniformSphere(random.next2D())) * 4.0;
        const Vec3d to = Vec3d(sampleUniformSphere(random.next2D())) * 1.2;
        const Vec3d way = normalize(to - from);
        const RayRoots roots = shape.roots(from, way);
        for (std::uint32_t r = 0; r < roots.count; ++r) {
            const Vec3d at = from + way * roots.t[r];
            Surface surface;
            shape.surfaceNear(at, surface);
            EXPECT_LT(length(Vec3d(surface.position) - at), 1e-6);
            // Beside it along the surface, a second root is as far as the curve bends.
            const Vec3d n(surface.geometricNormal), aside = normalize(cross(n, way));
            const RayRoots beside = shape.roots(at + n * 1e-3 + aside * 1e-4, n * -1.0);
            ASSERT_EQ(beside.count, 2u);
            EXPECT_NEAR(beside.t[0], 1e-3, 1e-6);
            EXPECT_EQ(dot(n, way) < 0, r == 0) << "the front is outside";
            ++met;
        }
    }
    EXPECT_GT(met, 500);
}

// Of a long one: 2 pi a^2 (1 + c / (a e) asin e).
TEST(Ellipsoid, HasItsAreaAndItsBox) {
    const double a = 0.7, c = 2, e = std::sqrt(1 - a * a / (c * c));
    const CurvedShape shape = placed({{}, 1}, {a, 0, 0, 1, 0, a, 0, 2, 0, 0, c, 3});
    EXPECT_NEAR(shape.area(), 2 * std::numbers::pi * a * a * (1 + c / (a * e) * std::asin(e)),
                2e-3);
    EXPECT_EQ(shape.bounds().middle(), Vec3d(1, 2, 3));
    EXPECT_LT(length(shape.bounds().size() - Vec3d(2 * a, 2 * a, 2 * c)), 1e-14);
    EXPECT_EQ(shape.sphere(), nullptr);
    EXPECT_NE(placed({{}, 1}, kIdentityTransform).sphere(), nullptr);
}

TEST(Ellipsoid, ThatIsFlatIsRefused) {
    EXPECT_THROW(placed({{}, 1}, {1, 0, 0, 0, 0, 1, 0, 0, 1, 1, 0, 0}), Error);
}

// Grey in an even sky is as bright as what it reflects; clear glass is as bright as the sky.
TEST(Ellipsoid, ReflectsAnEvenSky) {
    for (const bool isGlass : {false, true}) {
        SceneMaker maker;
        maker.sky(Rgb(0.8f));
        MaterialDescription glass;
        glass.kind = MaterialKind::kDielectric;
        glass.ior = 1.5f;
        const auto material = isGlass ? maker.material(glass) : maker.diffuse(Rgb(0.5f));
        const auto scene = egg(kAskew, material, maker).build();
        for (const IntegratorKind integrator : {IntegratorKind::kPath, IntegratorKind::kPhoton}) {
            const RenderSettings settings = smallFrame(16, 16, integrator, 4, 3);
            const Measured found =
                measureRegions(scene, settings, {0, 0, 16, 16}, {{7, 7, 9, 9}}).back().beauty;
            EXPECT_TRUE(agrees(found, Rgb(isGlass ? 0.8f : 0.4f), 0.003, 4));
        }
    }
}

}  // namespace
}  // namespace pm::test
