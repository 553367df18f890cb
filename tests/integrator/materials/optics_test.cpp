// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Rays through glass and off mirrors against geometrical optics: the same intersections and lobes
// that camera paths and photons take, without their random numbers.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "integrator/materials/bsdf.h"
#include "tests/support/rooms.h"
#include "tests/support/scene_maker.h"

namespace pm::test {
namespace {

constexpr double kPiD = std::numbers::pi;

double degrees(double radians) {
    return radians * 180 / kPiD;
}

// A ray that takes the lobe it is told to at each surface. World space; the scenes below have their
// centre at the origin unless they say otherwise.
class Walk {
  public:
    Walk(const Scene& scene, Vec3d from, Vec3d direction)
        : m_scene(scene), m_ray{Vec3f(from - scene.centre()), Vec3f(normalize(direction))} {}

    // False when it met nothing or the surface has no such lobe.
    bool scatter(Lobe lobe) {
        if (!m_scene.intersect(m_ray, m_surface)) return false;
        const Bsdf bsdf(m_scene.materials(), m_surface, -m_ray.direction, Transport::kRadiance,
                        Rgb(1.0f));
        BsdfSample sample;
        // Reflection comes first among a dielectric's lobes, refraction last.
        const float u = lobe == Lobe::kReflection ? 0.0f : 0.99999f;
        if (!bsdf.sample(u, {0.5f, 0.5f}, sample) || sample.lobe != lobe) return false;
        m_ray = rayFrom(m_surface, sample.direction);
        return true;
    }
    Vec3d origin() const { return Vec3d(m_ray.origin) + m_scene.centre(); }
    Vec3d direction() const { return normalize(Vec3d(m_ray.direction)); }
    // Where the ray's line comes to x = 0.
    Vec3d atAxis() const { return origin() - direction() * (origin().x / direction().x); }

  private:
    const Scene& m_scene;
    Ray m_ray;
    Surface m_surface;
};

std::shared_ptr<const Scene> ball(const MaterialDescription& material) {
    SceneMaker maker;
    maker.sphere({0, 0, 0}, 1, maker.material(material));
    return maker.build();
}

// A ball lens focuses paraxial rays n / (2(n - 1)) from its centre (D9).
TEST(Optics, BallLens) {
    for (const auto& [ior, focus] : {std::pair{1.5f, 1.5}, {1.33f, 2.01515}, {1.8f, 1.125}}) {
        const auto scene = ball(glass(ior));
        Walk walk(*scene, {0.01, 0, -3}, {0, 0, 1});
        ASSERT_TRUE(walk.scatter(Lobe::kRefraction) && walk.scatter(Lobe::kRefraction));
        // Spherical aberration draws it nearer, by about h^2 = 1e-4.
        EXPECT_NEAR(walk.atAxis().z, focus, 1e-3) << ior;
        Walk marginal(*scene, {0.5, 0, -3}, {0, 0, 1});
        ASSERT_TRUE(marginal.scatter(Lobe::kRefraction) && marginal.scatter(Lobe::kRefraction));
        EXPECT_LT(marginal.atAxis().z, 0.99 * focus);
    }
}

// The inside of a mirror ball: a ray at height h = sin(phi) crosses the axis 1 / (2 cos(phi)) from
// the centre (D13), and neighbours cross each other cos(phi) / 2 along it, on a nephroid with its
// cusp at 1/2 (D14).
TEST(Optics, SphericalMirror) {
    const auto scene = ball(mirror());
    for (const double h : {0.01, 0.25, 0.5, 0.8}) {
        const double cosine = std::sqrt(1 - h * h);
        Walk walk(*scene, {h, 0, -0.5}, {0, 0, 1});
        Walk neighbour(*scene, {h + 1e-3, 0, -0.5}, {0, 0, 1});
        ASSERT_TRUE(walk.scatter(Lobe::kReflection) && neighbour.scatter(Lobe::kReflection));
        EXPECT_NEAR(walk.atAxis().z, 1 / (2 * cosine), h < 0.1 ? 1e-4 : 1e-5) << h;
        const Vec3d between = neighbour.origin() - walk.origin();
        const Vec3d a = walk.direction(), b = neighbour.direction();
        const double along = (between.x * b.z - between.z * b.x) / (a.x * b.z - a.z * b.x);
        EXPECT_NEAR(along, cosine / 2, 2e-3) << h;
    }
}

// Least deviation of a prism: sin((A + D)/2) / sin(A/2) = n (D16).
TEST(Optics, PrismDeviation) {
    SceneMaker maker;
    const auto material = maker.material(glass());
    const double half = std::tan(kPiD / 6);
    const Vec3d y{0, 10, 0};
    // Its apex of 60 degrees at x = 0, z = 1.
    maker.quad({-half, -5, 0}, Vec3d{half, 0, 1}, y, material);
    maker.quad({half, -5, 0}, y, Vec3d{-half, 0, 1}, material);
    maker.quad({-half, -5, 0}, y, {2 * half, 0, 0}, material);
    const auto scene = maker.build();
    const auto deviation = [&](double incidence) {
        // The left face's normal points 150 degrees from +x; light comes along it, turned.
        const double angle = kPiD / 6 * 5 + incidence;
        const Vec3d from{std::cos(angle), 0, std::sin(angle)};
        Walk walk(*scene, Vec3d{-half / 2, 0, 0.5} + from * 2, -from);
        EXPECT_TRUE(walk.scatter(Lobe::kRefraction) && walk.scatter(Lobe::kRefraction));
        return degrees(std::acos(dot(walk.direction(), -from)));
    };
    const double least = (60 + 37.1808) / 2 * kPiD / 180;
    EXPECT_NEAR(deviation(least), 37.1808, 2e-4);
    EXPECT_GT(deviation(least + 0.1), 37.3);
    EXPECT_GT(deviation(least - 0.1), 37.3);
}

// A rainbow is where light turned back once inside a drop comes out farthest from the way back
// (D17).
TEST(Optics, Rainbow) {
    const double n = 1.333;
    const auto scene = ball(glass(static_cast<float>(n)));
    const auto fromWayBack = [&](double incidence) {
        Walk walk(*scene, {std::sin(incidence), 0, -3}, {0, 0, 1});
        EXPECT_TRUE(walk.scatter(Lobe::kRefraction) && walk.scatter(Lobe::kReflection) &&
                    walk.scatter(Lobe::kRefraction));
        return degrees(std::acos(-walk.direction().z));
    };
    const double incidence = std::acos(std::sqrt((n * n - 1) / 3));
    EXPECT_NEAR(fromWayBack(incidence), 42.0781, 2e-3);
    EXPECT_LT(fromWayBack(incidence + 0.1), 42.0);
    EXPECT_LT(fromWayBack(incidence - 0.1), 42.0);
}

// Under water: the world above within 97.2 degrees, and what lies at a depth seen at 0.75 of it
// (D18; D5).
TEST(Optics, WaterSurface) {
    SceneMaker maker;
    maker.quad({-50, -50, 0}, {100, 0, 0}, {0, 100, 0}, maker.material(glass(1.333f)));
    const auto scene = maker.build();
    const auto leaves = [&](double angle) {
        const double a = angle * kPiD / 180;
        return Walk(*scene, {0, 0, -2}, {std::sin(a), 0, std::cos(a)}).scatter(Lobe::kRefraction);
    };
    EXPECT_TRUE(leaves(97.20 / 2 - 0.01));
    EXPECT_FALSE(leaves(97.20 / 2 + 0.01));
    Walk walk(*scene, {0, 0, -2}, {0.01, 0, 1});
    ASSERT_TRUE(walk.scatter(Lobe::kRefraction));
    EXPECT_NEAR(walk.atAxis().z / -2, 0.7502, 2e-4);
}

}  // namespace
}  // namespace pm::test
