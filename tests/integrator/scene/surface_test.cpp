// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Points on surfaces and the rays that leave them: never back into what they left, at any size and
// place; fronts under mirroring; the same picture wherever the scene stands.
#include "integrator/shapes/surface.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "integrator/light_sampling/light_sampler.h"
#include "integrator/sampling/sampler.h"
#include "integrator/scene/camera.h"
#include "integrator/shapes/huge_triangles.h"
#include "integrator/transport/path/path_integrator.h"
#include "tests/support/scene_maker.h"
#include "tests/support/statistics.h"

namespace pm::test {
namespace {

// Directions on both sides, one in two within 1e-4 of the surface's plane.
Vec3f leaving(const Surface& surface, Random& random) {
    const Frame frame(surface.geometricNormal);
    Vec3f d = sampleUniformSphere(random.next2D());
    if (random.next() < 0.5f) d.z *= 1e-4f * random.next();
    return normalize(frame.toWorld(d));
}

void addTriangle(SceneMaker& maker, Vec3d a, Vec3d b, Vec3d c, std::uint32_t material) {
    maker.quad(a, b - a, c - a, material);
    auto mesh =
        *std::get<std::shared_ptr<const TriangleMesh>>(maker.description.instances.back().shape);
    mesh.positions = {Vec3f(a), Vec3f(b), Vec3f(c)};
    mesh.triangles = {{0, 1, 2}};
    mesh.materials.resize(1);
    mesh.faces.resize(1);
    maker.description.instances.back().shape =
        std::make_shared<const TriangleMesh>(std::move(mesh));
}

// How many of a thousand rays off each of a scene's lamps meet what they left, in all.
int metAgain(const SceneMaker& maker, Random& random) {
    const auto scene = maker.build();
    int met = 0;
    for (const Light& light : scene->lights())
        for (int n = 0; n < 1000; ++n) {
            const Surface from = scene->pointOnLight(light, random.next2D());
            Surface to;
            met += scene->intersect(rayFrom(from, leaving(from, random)), to) &&
                   to.shape == from.shape;
        }
    return met;
}

// Triangles of sizes 1e-4 to 1e3, fat to 1 : 1e4, anywhere within 10 units of the origin.
TEST(SurfaceOffset, TrianglesAreLeft) {
    Random random(1);
    SceneMaker maker;
    const auto lamp = maker.diffuse({}, Rgb(1.0f));
    const auto direction = [&] { return Vec3d(sampleUniformSphere(random.next2D())); };
    for (int i = 0; i < 400; ++i) {
        const double size = std::pow(10.0, -4 + 7 * static_cast<double>(random.next()));
        const double thin = std::pow(10.0, -4 * static_cast<double>(random.next()));
        const Vec3d at = direction() * 10.0, along = direction() * size;
        addTriangle(maker, at, at + along, at + along * 0.3 + direction() * (size * thin), lamp);
    }
    EXPECT_EQ(metAgain(maker, random), 0);
}

// Of sizes 1 to 1e6, along two axes but for a tilt of 0 or 1e-9 to 0.1: their boxes are flat, so
// rays start nearer to them.
TEST(SurfaceOffset, TrianglesAlongTheAxesAreLeft) {
    Random random(5);
    SceneMaker maker;
    const auto lamp = maker.diffuse({}, Rgb(1.0f));
    const auto within = [&](double reach) {
        return reach * (2 * static_cast<double>(random.next()) - 1);
    };
    for (int i = 0; i < 400; ++i) {
        const double size = std::pow(10.0, 6 * static_cast<double>(random.next()));
        const double thin = std::pow(10.0, -3 * static_cast<double>(random.next()));
        const double tilt =
            i % 4 == 0 ? 0.0 : size * std::pow(10.0, -9 + 8 * static_cast<double>(random.next()));
        const Vec3d at{within(10), within(10), within(10)};
        const Vec3d along{within(size), within(tilt), size};
        addTriangle(maker, at, at + along, at + along * 0.3 + Vec3d{size * thin, within(tilt), 0},
                    lamp);
    }
    EXPECT_EQ(metAgain(maker, random), 0);
}

// Without the offset they would be met: the test can see it.
TEST(SurfaceOffset, IsNeeded) {
    Random random(2);
    SceneMaker maker;
    addTriangle(maker, {1, 2, 3}, {2, 2.5, 3.3}, {1.2, 3, 4}, maker.diffuse({}, Rgb(1.0f)));
    const auto scene = maker.build();
    int met = 0;
    for (int n = 0; n < 10'000; ++n) {
        Surface from = scene->pointOnLight(scene->lights()[0], random.next2D());
        from.offset = 0.0f;
        Surface to;
        met += scene->intersect(rayFrom(from, leaving(from, random)), to);
    }
    EXPECT_GT(met, 100);
}

// Spheres of radius .015 and 1e-4 (hard cases R7) to 1e5, some through the origin: outwards
// nothing, inwards the far side.
TEST(SurfaceOffset, SpheresAreLeft) {
    Random random(3);
    for (const double radius : {1e-4, 0.015, 1.0, 1e5})
        for (const Vec3d centre : {Vec3d{3, -2, 1}, Vec3d{0, -radius, 0}, Vec3d{0, 0, 0}}) {
            SceneMaker maker;
            maker.sphere(centre, radius, maker.diffuse({}, Rgb(1.0f)));
            // Something that keeps the scene's centre near the origin.
            const double reach = 2 * radius + 5;
            maker.box({-reach, -reach, -reach}, {reach, reach, reach}, maker.diffuse(Rgb(0.5f)),
                      true);
            const auto scene = maker.build();
            int wrong = 0;
            for (int n = 0; n < 20'000; ++n) {
                const Surface from = scene->pointOnLight(scene->lights()[0], random.next2D());
                const Vec3f d = leaving(from, random);
                Surface to;
                if (!scene->intersect(rayFrom(from, d), to)) continue;
                const float cosine = dot(d, from.geometricNormal);
                const double chord = -2 * static_cast<double>(cosine) * radius;
                const auto travelled = static_cast<double>(length(to.position - from.position));
                wrong += cosine >= 0.0f
                             ? to.shape == from.shape
                             : to.shape != from.shape ||
                                   travelled < 0.9 * chord - 8 * static_cast<double>(from.offset);
            }
            EXPECT_EQ(wrong, 0) << "radius " << radius << " centre " << centre.x << " " << centre.y;
        }
}

// A point of a big sphere that happens to lie at the origin has no float rounding to hide behind.
TEST(SurfaceOffset, SphereThroughTheOrigin) {
    SceneMaker maker;
    maker.sphere({0, -1e5, 0}, 1e5, maker.diffuse(Rgb(0.5f)));
    maker.sphere({0, 1e5 + 2, 0}, 1e5, maker.diffuse(Rgb(0.5f)));
    const auto scene = maker.build();  // its centre is (0, 1, 0)
    Random random(4);
    int met = 0;
    for (int n = 0; n < 100'000; ++n) {
        const float span = std::pow(10.0f, -8.0f + 8.0f * random.next());
        Surface from, to;
        const Vec3f above{span * (random.next() - 0.5f), 0, span * (random.next() - 0.5f)};
        ASSERT_TRUE(scene->intersect({above, {0, -1, 0}}, from));
        Vec3f d = leaving(from, random);
        if (dot(d, from.geometricNormal) < 0.0f) d = -d;
        met += scene->intersect(rayFrom(from, d), to) && to.shape == from.shape;
    }
    EXPECT_EQ(met, 0);
}

// A mirroring transform keeps the emitting side.
TEST(Surface, MirroredInstanceEmitsFromItsFront) {
    for (const double sx : {1.0, -1.0})
        for (const double sy : {1.0, -1.0}) {
            SceneMaker maker;
            maker.quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, maker.diffuse({}, Rgb(1.0f)));
            maker.description.instances[0].transform = {sx, 0, 0, 3, 0, sy, 0, 0, 0, 0, 1, 0};
            maker.camera({3, 0, 4}, {3, 0, 0}, {0, 1, 0}, 20);
            EXPECT_TRUE(agrees(
                measure(maker.build(), smallFrame(8, 8, IntegratorKind::kPath, 1, 2)).emission,
                Rgb(1.0f), 0));
            maker.camera({3, 0, -4}, {3, 0, 0}, {0, 1, 0}, 20);
            EXPECT_TRUE(agrees(
                measure(maker.build(), smallFrame(8, 8, IntegratorKind::kPath, 1, 2)).emission,
                Rgb(0.0f), 0));
        }
}

// Files wind faces the other way round than their normals point.
TEST(Surface, NormalsOfFacesWoundTheOtherWay) {
    const Vec3d normal = normalize(Vec3d{0.4, -0.3, 1});
    for (const double sign : {1.0, -1.0}) {
        SceneMaker maker;
        maker.quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, maker.diffuse(Rgb(0.5f)));
        maker.bendNormals(normal * sign);
        Surface surface;
        ASSERT_TRUE(maker.build()->intersect({{0.1f, 0.2f, 1}, {0, 0, -1}}, surface));
        EXPECT_EQ(surface.geometricNormal, (Vec3f{0, 0, 1}));
        EXPECT_LT(length(surface.shadingNormal - Vec3f(normal)), 1e-6f) << sign;
    }
}

// A two-sided quad between two lamps shows both sides lit (hard cases P2): E = pi L sin^2 each.
TEST(Surface, BothSidesAreLit) {
    for (const double side : {1.0, -1.0})
        for (const auto integrator : {IntegratorKind::kPhoton, IntegratorKind::kPath}) {
            SceneMaker maker;
            maker.quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, maker.diffuse(Rgb(0.5f)));
            const auto lamp = maker.diffuse({}, Rgb(1.0f));
            maker.sphere({0, 0, 2}, 0.5, lamp);
            maker.sphere({0, 0, -2}, 0.5, lamp);
            maker.camera({0.5, 0, side}, {0, 0, 0}, {0, 1, 0}, 0.2);
            EXPECT_TRUE(agrees(measure(maker.build(), smallFrame(8, 8, integrator, 4, 4)).beauty,
                               Rgb(0.5f / 16), 1e-3));
        }
}

// Covered pixels of a unit sphere seen from so many radii, the view angle to match (R6).
double discShare(double distance) {
    SceneMaker maker;
    maker.sphere({0, 0, 0}, 1, maker.diffuse({}, Rgb(1.0f)));
    const double visible = std::asin(1 / distance);
    maker.camera({0, 0, distance}, {0, 0, 0}, {0, 1, 0},
                 2 * 180 / std::numbers::pi * std::atan(1.25 * std::tan(visible)));
    const auto scene = maker.build();
    const Camera camera(*scene, 512, 512);
    int covered = 0;
    Surface surface;
    for (int y = 0; y < 512; ++y)
        for (int x = 0; x < 512; ++x)
            covered += scene->intersect(camera.ray({x + 0.5, y + 0.5}), surface);
    return covered / (512.0 * 512.0);
}

TEST(Surface, TheSameDiscFromAnyDistance) {
    const double expected = std::numbers::pi / 4 / (1.25 * 1.25);
    for (const double distance : {2.5, 6.5, 7.5, 10.0, 100.0, 1000.0, 1e5})
        EXPECT_NEAR(discShare(distance), expected, 3e-4) << distance;
}

// Two balls under a lamp, on a ground of that half side, turned about z by `tilt` (radians).
std::vector<float> picture(Vec3d shift, double ground = 4, bool indirectToo = true,
                           double tilt = 0) {
    SceneMaker maker;
    const auto grey = maker.diffuse(Rgb(0.6f));
    maker.quad({-ground, 0, ground}, {2 * ground, 0, 0}, {0, 0, -2 * ground}, grey);
    const double c = std::cos(tilt), s = std::sin(tilt);
    maker.description.instances.back().transform = {c, -s, 0, 0, s, c, 0, 0, 0, 0, 1, 0};
    maker.meshSphere({-1, 1, 0}, 0.75, grey, false, 12);
    maker.sphere({1, 1, 0}, 0.75, grey);
    maker.quad({-1, 4, -1}, {2, 0, 0}, {0, 0, 2}, maker.diffuse({}, Rgb(5.0f)));
    maker.camera({0, 2, 6}, {0, 1, 0}, {0, 1, 0}, 45);
    for (auto& instance : maker.description.instances)
        for (int axis = 0; axis < 3; ++axis)
            instance.transform[static_cast<std::size_t>(4 * axis + 3)] = shift[axis];
    for (int axis = 0; axis < 3; ++axis)
        maker.description.camera->cameraToWorld[static_cast<std::size_t>(4 * axis + 3)] +=
            shift[axis];
    const auto scene = maker.build();
    const LightSampler lights(*scene);
    const Camera camera(*scene, 32, 24);
    std::vector<float> pixels;
    for (std::uint64_t i = 0; i < 32 * 24; ++i) {
        Sampler sampler(1, 0, i, 0);
        const Ray ray =
            camera.ray({static_cast<double>(i % 32) + 0.5, static_cast<double>(i / 32) + 0.5});
        const SampleRadiance s = PathIntegrator(*scene, lights).sample(ray, sampler);
        pixels.push_back((indirectToo ? s.direct + s.indirect + s.emission : s.direct).g);
    }
    return pixels;
}

// Wherever the scene stands in the world (R5): the same paths, the same values to float rounding
// of the instances' transform.
TEST(Surface, TheSamePictureFarFromTheOrigin) {
    const std::vector<float> home = picture({0, 0, 0});
    for (const double far : {8e5, 8e6}) {
        const std::vector<float> away = picture({far, -far, far});
        int different = 0;
        for (std::size_t i = 0; i < home.size(); ++i)
            different += !(std::abs(home[i] - away[i]) <= 1e-4f * (1.0f + home[i]));
        EXPECT_LE(different, 3) << far;  // paths on a limb or a shadow's edge
    }
}

// However large the ground is that all stands on (R1, R9): neither shadows nor the diagonal of its
// two triangles move.
TEST(Surface, TheSamePictureOnAnyGround) {
    const std::vector<float> small = picture({0, 0, 0}, 50, false);
    for (const double ground : {1e4, 1e5, 1e6, 1e9}) {
        const std::vector<float> large = picture({0, 0, 0}, ground, false);
        int different = 0;
        for (std::size_t i = 0; i < small.size(); ++i)
            different += !(std::abs(small[i] - large[i]) <= 1e-4f * (1.0f + small[i]));
        EXPECT_LE(different, 3) << ground;
    }
}

// The same of grounds along no axis: their triangles are intersected in double.
TEST(Surface, TheSamePictureOnAnyTiltedGround) {
    for (const double tilt : {0.2, -0.03}) {
        const std::vector<float> small = picture({0, 0, 0}, 50, false, tilt);
        for (const double ground : {300.0, 1e3, 1e4, 1e5, 1e6, 1e9}) {
            const std::vector<float> large = picture({0, 0, 0}, ground, false, tilt);
            int different = 0;
            for (std::size_t i = 0; i < small.size(); ++i)
                different += !(std::abs(small[i] - large[i]) <= 1e-4f * (1.0f + small[i]));
            EXPECT_LE(different, 3) << ground << " tilt " << tilt;
        }
    }
}

// A tilted ground and a ball at its middle.
std::shared_ptr<const Scene> ballOnGround(double ground, bool emits) {
    SceneMaker maker;
    maker.quad({-ground, 0, ground}, {2 * ground, 0, 0}, {0, 0, -2 * ground},
               maker.diffuse(Rgb(0.5f), Rgb(emits ? 1.0f : 0.0f)));
    const double c = std::cos(0.3), s = std::sin(0.3);
    maker.description.instances.back().transform = {c, -s, 0, 0, s, c, 0, 0, 0, 0, 1, 0};
    maker.sphere({0, 1, 0}, 0.75, maker.diffuse(Rgb(0.6f)));
    return maker.build();
}

// Rays that come from near and are aimed at a huge ground's diagonal meet it, where it is to
// double; those that leave it don't.
TEST(SurfaceOffset, HugeGroundsAreMetAndLeft) {
    for (const double ground : {1e4, 1e6, 1e9}) {
        const auto scene = ballOnGround(ground, true);
        Random random(6);
        int missed = 0, off = 0, metAgain = 0;
        const Vec3d normal{-std::sin(0.3), std::cos(0.3), 0};
        for (int n = 0; n < 20'000; ++n) {
            // Across the diagonal, by less and less.
            const double along = 4 * static_cast<double>(random.next()) - 2;
            const double across = std::pow(10.0, -14.0 * static_cast<double>(random.next()));
            const Vec3d flat{along + across, 0, -along};
            const Vec3d target{flat.x * std::cos(0.3), flat.x * std::sin(0.3), flat.z};
            const Vec3d eye = normal * 0.01 + target * 1.2;
            Surface from, to;
            const Vec3f start(eye - scene->centre());
            if (!scene->intersect({start, Vec3f(target - eye)}, from) || from.shape != 0) {
                ++missed;
                continue;
            }
            // What rounding to float leaves of it.
            const Vec3d p = Vec3d(from.position) + scene->centre();
            off += std::abs(dot(p, normal)) > 3 * 0x1p-24 * (length(scene->centre()) + 10);
            Vec3f d = leaving(from, random);
            if (dot(d, from.geometricNormal) < 0.0f) d = -d;
            // Nearer to the plane, float can't tell the side.
            if (dot(Vec3d(d), normal) < 0x1p-22) continue;
            metAgain += scene->intersect(rayFrom(from, d), to) && to.shape == 0;
        }
        EXPECT_EQ(missed, 0) << ground;
        EXPECT_EQ(off, 0) << ground;
        EXPECT_EQ(metAgain, 0) << ground;
    }
}

// Few shapes: nothing says what is small. Many and all alike: none is huge.
TEST(HugeTriangles, AreThoseBesideWhichAllIsSmall) {
    const auto most = [](const std::vector<double>& sizes) {
        HugeTriangles huge;
        for (const double size : sizes) huge.addSize(size);
        for (const double size : sizes) huge.addBox(size, Vec3d(0.0), Vec3d(size));
        return huge.mostNotHuge();
    };
    const double none = std::numeric_limits<double>::infinity();
    EXPECT_EQ(most({}), none);
    EXPECT_EQ(most({1e6}), none);
    EXPECT_EQ(most({1e6, 1e6}), none);
    EXPECT_EQ(most({1.0, 100.0, 10'000.0}), none);
    EXPECT_EQ(most({0.0, 0.0, 1.0}), none);  // points are no measure
    const double width = HugeTriangles::kTimes * std::sqrt(3.0);
    EXPECT_NEAR(most({1e6, 1.0, 1e5}), width, 1e-9 * width);
    EXPECT_NEAR(most({1.0, 1e9, 1e6, 1e9}), width, 1e-9 * width);
    std::vector<double> many(HugeTriangles::kMost + 10, 2.0);
    EXPECT_EQ(most(many), none);
    many.front() = many.back() = 1e6;
    EXPECT_NEAR(most(many), 2 * width, 1e-9 * width);
    // Of more than are looked for none is huge.
    std::vector<double> fine(HugeTriangles::kMost + 10, 1e6);
    fine.back() = 1.0;
    EXPECT_EQ(most(fine), none);
}

}  // namespace
}  // namespace pm::test
