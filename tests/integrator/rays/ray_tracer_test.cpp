// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Rays that would end the process, leaks, and spheres from far away.
#include "integrator/rays/ray_tracer.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <fstream>
#include <limits>

#include "integrator/scene/scene.h"
#include "integrator/values/error.h"
#include "tests/support/scene_maker.h"
#include "tests/support/statistics.h"

namespace pm::test {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

std::shared_ptr<const Scene> unitScene() {
    SceneMaker maker;
    const auto grey = maker.diffuse(Rgb(0.5f));
    maker.meshSphere({0, 0, 0}, 1, grey, false, 16);
    maker.sphere({0, 0, 0}, 0.5, grey);
    return maker.build();
}

TEST(RayTracer, UnusableRaysMeetNothing) {
    const auto scene = unitScene();
    Surface surface;
    ASSERT_TRUE(scene->intersect({{0, 0, 5}, {0, 0, -1}}, surface));
    for (const float bad : {kNan, kInfinity, -kInfinity, 1e19f, -1e19f})
        for (int axis = 0; axis < 3; ++axis) {
            Ray origin{{0, 0, 5}, {0, 0, -1}}, direction = origin;
            origin.origin[axis] = bad;
            direction.direction[axis] = bad;
            EXPECT_FALSE(scene->intersect(origin, surface)) << bad;
            EXPECT_FALSE(scene->intersect(direction, surface)) << bad;
            // No light comes by a ray that can't be traced.
            EXPECT_TRUE(scene->occluded(origin));
            EXPECT_TRUE(scene->occluded(direction));
        }
    for (const float tMax : {kNan, -1.0f, -kInfinity})
        EXPECT_FALSE(scene->intersect({{0, 0, 5}, {0, 0, -1}, tMax}, surface)) << tMax;
}

TEST(RayTracer, StrangeButFiniteRaysReturn) {
    const auto scene = unitScene();
    Surface surface;
    EXPECT_FALSE(scene->intersect({{0, 0, 5}, {0, 0, 0}}, surface));
    scene->intersect({{0, 0, 5}, {1e-40f, 0, -1e-40f}}, surface);
    scene->intersect({{1e18f, -1e18f, 1e18f}, {-1e18f, 1e18f, -1e18f}}, surface);
    EXPECT_FALSE(scene->intersect({{0, 0, 5}, {0, 0, -1}, 0.0f}, surface));
    EXPECT_FALSE(scene->intersect({{0, 0, 5}, {0, 0, -1}, 3.9f}, surface));
    EXPECT_TRUE(scene->intersect({{0, 0, 5}, {0, 0, -1}, 4.1f}, surface));
    EXPECT_FALSE(scene->occluded({{0, 0, 5}, {0, 0, -1}, 3.9f}));
    EXPECT_TRUE(scene->occluded({{0, 0, 5}, {0, 0, -1}, 4.1f}));
}

// From inside a closed mesh that stands far from the origin: nothing gets out.
TEST(RayTracer, FarMeshesAreWatertight) {
    SceneMaker maker;
    maker.meshSphere({0, 0, 0}, 1, maker.diffuse(Rgb(0.5f)), true, 100);
    maker.description.instances[0].transform = {1, 0, 0, 8e5, 0, 1, 0, -8e5, 0, 0, 1, 8e5};
    const auto scene = maker.build();
    EXPECT_NEAR(scene->centre().x, 8e5, 1e-6);
    Random random(1);
    int leaks = 0;
    Surface surface;
    for (int i = 0; i < 1'000'000; ++i) {
        const Vec3f origin = sampleUniformSphere(random.next2D()) * (0.9f * random.next());
        leaks += !scene->intersect({origin, sampleUniformSphere(random.next2D())}, surface);
    }
    EXPECT_EQ(leaks, 0);
}

// A camera's distance in radii (hard cases R6, R13): the hit stays exact, the limb stays sharp.
TEST(IntersectSphere, FromFarAway) {
    for (const double distance : {10.0, 1e3, 1e5, 1e7, 1e9}) {
        const Vec3d centre{0.25, -0.5, 0};
        const double radius = 1;
        for (const double height : {0.0, 0.5, 0.999, 0.9999999}) {
            const double t =
                intersectSphere({0.25, -0.5 + height, distance}, {0, 0, -1}, 1e300, centre, radius);
            const double expected = distance - std::sqrt(1 - height * height);
            EXPECT_NEAR(t, expected, 4e-16 * distance + 1e-9) << distance << " " << height;
        }
        EXPECT_LT(intersectSphere({0.25, 0.5 + 1e-9, distance}, {0, 0, -1}, 1e300, centre, radius),
                  0);
    }
}

// The same hits and misses as by the formula in long double, near and far, from inside and out,
// where the line passes the sphere's limb by more than a few roundings.
TEST(IntersectSphere, AsInLongDouble) {
    using Real = long double;
    Random random(3);
    int hits = 0, misses = 0, doubtful = 0;
    for (int i = 0; i < 200'000; ++i) {
        const double radius = std::exp(10.0 * static_cast<double>(random.next()) - 5.0);
        const double away = radius * std::exp(14.0 * static_cast<double>(random.next()) - 2.0);
        const Vec3d origin = Vec3d(sampleUniformSphere(random.next2D())) * away;
        // To a point about the limb, or anywhere.
        const double aside = radius * (1 + 0.5 * (static_cast<double>(random.next()) - 0.5));
        const Vec3d at = Vec3d(sampleUniformSphere(random.next2D())) * aside;
        const Vec3d direction = (at - origin) * (random.next() < 0.2f ? -1e-3 : 3.0);
        const Real f2 =
            Real(origin.x) * origin.x + Real(origin.y) * origin.y + Real(origin.z) * origin.z;
        const Real a = Real(direction.x) * direction.x + Real(direction.y) * direction.y +
                       Real(direction.z) * direction.z;
        const Real b = -(Real(origin.x) * direction.x + Real(origin.y) * direction.y +
                         Real(origin.z) * direction.z);
        const Real c = f2 - Real(radius) * radius, discriminant = b * b - a * c;
        if (std::abs(discriminant) < 1e-12L * a * f2) {
            ++doubtful;
            continue;
        }
        Real expected = -1;
        if (discriminant > 0) {
            const Real q = b + std::copysign(std::sqrt(discriminant), b);
            const Real t0 = std::min(c / q, q / a), t1 = std::max(c / q, q / a);
            expected = t0 > 0 ? t0 : t1;
        }
        const double t = intersectSphere(origin, direction, 1e300, Vec3d(0.0), radius);
        ASSERT_EQ(t > 0, expected > 0) << i;
        (expected > 0 ? hits : misses) += 1;
        if (!(expected > 0)) continue;
        // Roundings of 2^-53 beneath a root of 1e-12 and more.
        ASSERT_NEAR(t, static_cast<double>(expected), 1e-9 * static_cast<double>(std::sqrt(f2 / a)))
            << i;
    }
    EXPECT_GT(hits, 20'000);
    EXPECT_GT(misses, 20'000);
    EXPECT_LT(doubtful, 20'000);
}

TEST(IntersectSphere, RootsInRange) {
    const Vec3d c{0, 0, 0};
    EXPECT_NEAR(intersectSphere({0, 0, 0}, {0, 0, 1}, 10, c, 2), 2, 1e-15);     // from inside
    EXPECT_NEAR(intersectSphere({0, 0, 5}, {0, 0, -2}, 10, c, 2), 1.5, 1e-15);  // not unit
    EXPECT_LT(intersectSphere({0, 0, 5}, {0, 0, 1}, 10, c, 2), 0);              // behind
    EXPECT_LT(intersectSphere({0, 0, 5}, {0, 0, -1}, 2.9, c, 2), 0);            // too far
    EXPECT_LT(intersectSphere({0, 0, 5}, {0, 0, 0}, 10, c, 2), 0);
    EXPECT_LT(intersectSphere({0, 0, 2}, {1, 0, 0}, 10, c, 2), 0);  // touches at its origin
}

TEST(RayTracer, InstructionSets) {
    EXPECT_NE(RayTracer("best").isa(), "best");
    EXPECT_EQ(RayTracer("").isa(), RayTracer("best").isa());
    EXPECT_EQ(RayTracer("sse2").isa(), "sse2");
    for (const char* bad : {"sse3", "AVX2", "avx2,threads=1", " ", "best "}) {
        try {
            RayTracer tracer(bad);
            ADD_FAILURE() << bad;
        } catch (const Error& error) {
            EXPECT_EQ(error.status(), Status::kInvalidArgument);
            EXPECT_NE(std::string(error.what()).find(bad), std::string::npos) << error.what();
        }
    }
}

// A ray tracer in a process that may take no address space beyond what it has. Ends the process.
[[noreturn, maybe_unused]] void traceWithoutMemory() {
    std::ifstream statm("/proc/self/statm");
    rlim_t pages = 0;
    statm >> pages;
    const rlim_t bytes = pages * static_cast<rlim_t>(sysconf(_SC_PAGESIZE)) + (rlim_t{1} << 20);
    const rlimit limit{bytes, bytes};
    if (setrlimit(RLIMIT_AS, &limit) != 0) _exit(3);
    try {
        const RayTracer tracer("best");
        _exit(2);
    } catch (const Error& error) {
        std::fputs(error.what(), stderr);
        _exit(error.status() == Status::kOutOfMemory ? 0 : 1);
    }
}

TEST(RayTracer, SaysWhenEmbreeHasNoMemory) {
#if defined(PM_ADDRESS_SANITIZER) || defined(PM_THREAD_SANITIZER)
    GTEST_SKIP() << "a sanitizer needs address space of its own";
#else
    GTEST_FLAG_SET(death_test_style, "threadsafe");
    EXPECT_EXIT(traceWithoutMemory(), testing::ExitedWithCode(0), "out of memory: Embree");
#endif
}

}  // namespace
}  // namespace pm::test
