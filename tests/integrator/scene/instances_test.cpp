// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Meshes that stand in many places and are in memory once.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <numbers>
#include <variant>
#include <vector>

#include "integrator/rays/shared_mesh.h"
#include "integrator/sampling/warps.h"
#include "integrator/values/transform.h"
#include "tests/support/draws.h"
#include "tests/support/scene_maker.h"

namespace pm::test {
namespace {

using Mesh = std::shared_ptr<const TriangleMesh>;

Transform times(const Transform& a, const Transform& b) {
    Transform product{};
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 4; ++j) {
            double sum = j == 3 ? a[4 * i + 3] : 0.0;
            for (std::size_t k = 0; k < 3; ++k) sum += a[4 * i + k] * b[4 * k + j];
            product[4 * i + j] = sum;
        }
    return product;
}

Transform moved(const Vec3d& by) {
    return {1, 0, 0, by.x, 0, 1, 0, by.y, 0, 0, 1, by.z};
}

Transform scaled(const Vec3d& by) {
    return {by.x, 0, 0, 0, 0, by.y, 0, 0, 0, 0, by.z, 0};
}

// About an axis that is none of the coordinates'.
Transform turned(double angle) {
    const Vec3d axis = normalize(Vec3d{1, 2, 3});
    const double c = std::cos(angle), s = std::sin(angle), d = 1 - c;
    const auto [x, y, z] = std::array{axis.x, axis.y, axis.z};
    return {c + d * x * x,     d * x * y - s * z, d * x * z + s * y, 0,
            d * x * y + s * z, c + d * y * y,     d * y * z - s * x, 0,
            d * x * z - s * y, d * y * z + s * x, c + d * z * z,     0};
}

// The instances of one mesh, as the scene describes them.
void instances(SceneMaker& maker, const Mesh& mesh, std::uint32_t material,
               const std::vector<Transform>& places) {
    for (const Transform& place : places) {
        InstanceDescription instance;
        instance.shape = mesh;
        instance.transform = place;
        instance.materials = {material};
        maker.description.instances.push_back(std::move(instance));
    }
}

// Each instance with a mesh of its own, which is then moved to its place.
SceneMaker flattened(const SceneMaker& maker) {
    SceneMaker flat = maker;
    for (InstanceDescription& instance : flat.description.instances)
        if (const auto* mesh = std::get_if<Mesh>(&instance.shape))
            instance.shape = std::make_shared<const TriangleMesh>(**mesh);
    return flat;
}

Mesh ball(int rings) {
    SceneMaker maker;
    maker.meshSphere({0, 0, 0}, 1, maker.diffuse(Rgb(0.5f)), false, rings);
    return std::get<Mesh>(maker.description.instances.back().shape);
}

// Of [0, 1]^2 at z = 0.
Mesh tile(std::uint32_t divisions) {
    SceneMaker maker;
    maker.quad({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, maker.diffuse(Rgb(0.5f)), divisions);
    return std::get<Mesh>(maker.description.instances.back().shape);
}

std::vector<Transform> anywhere(std::size_t count, double distance, double leastScale,
                                double mostScale) {
    Draws random(7, 0, 0, 0);
    std::vector<Transform> places;
    for (std::size_t i = 0; i < count; ++i) {
        const Vec2f a = random.next2D(), b = random.next2D(), c = random.next2D();
        const double scale =
            leastScale * std::pow(mostScale / leastScale, static_cast<double>(c.x));
        Vec3d at{static_cast<double>(a.x) - 0.5, static_cast<double>(a.y) - 0.5,
                 static_cast<double>(b.x) - 0.5};
        Transform place = times(moved(at * distance), turned(7 * static_cast<double>(b.y)));
        const double mirror = i % 3 == 0 ? -1 : 1;
        places.push_back(times(place, scaled({mirror * scale, scale, 0.8 * scale})));
    }
    return places;
}

// From anywhere, towards one of the instances or past it.
Ray somewhere(const Scene& scene, Draws& random) {
    const auto radius = static_cast<float>(scene.radius());
    const auto& all = scene.description().instances;
    const auto which = static_cast<std::size_t>(random.next1D() * static_cast<float>(all.size()));
    const Vec3d at = transformPoint(all[which].transform, Vec3d(0.0)) - scene.centre();
    const double size = std::abs(determinant(all[which].transform));
    const Vec3f aside = sampleUniformSphere(random.next2D()) * static_cast<float>(std::cbrt(size));
    const Vec3f from = sampleUniformSphere(random.next2D()) * (radius * random.next1D());
    return {from, normalize(Vec3f(at) + aside * 1.1f - from)};
}

SceneMaker manyBalls(const Mesh& mesh, double distance) {
    SceneMaker maker;
    instances(maker, mesh, maker.diffuse(Rgb(0.5f)), anywhere(60, distance, 0.3, 1.5));
    return maker;
}

TEST(Instances, AreThoseOfMeshesUsedOften) {
    const Mesh mesh = ball(8);
    SceneMaker once;
    instances(once, mesh, once.diffuse(Rgb(0.5f)), {kIdentityTransform});
    EXPECT_FALSE(once.build()->hasInstances());
    EXPECT_TRUE(manyBalls(mesh, 10).build()->hasInstances());
    EXPECT_FALSE(flattened(manyBalls(mesh, 10)).build()->hasInstances());
    // A transform that float would not do for, and what rays are not to meet.
    SceneMaker thin;
    instances(thin, mesh, thin.diffuse(Rgb(0.5f)),
              std::vector<Transform>(60, times(scaled({1, 1, 1e-3}), turned(1))));
    EXPECT_FALSE(thin.build()->hasInstances());
    MaterialDescription none;
    none.kind = MaterialKind::kDielectric;
    none.ior = 1.0f;
    SceneMaker invisible = manyBalls(mesh, 10);
    invisible.description.materials[0] = none;
    EXPECT_FALSE(invisible.build()->hasInstances());
}

// Rays meet what they meet when it is flattened, to the rounding of both.
TEST(Instances, AreMetWhereTheyAre) {
    for (const double distance : {10.0, 300.0}) {
        const SceneMaker maker = manyBalls(ball(8), distance);
        const auto scene = maker.build(), flat = flattened(maker).build();
        Draws random(1, 0, 0, 0);
        int met = 0, other = 0;
        for (int i = 0; i < 100'000; ++i) {
            const Ray ray = somewhere(*scene, random);
            Surface a, b;
            const bool inA = scene->intersect(ray, a), inB = flat->intersect(ray, b);
            if (inA != inB || (inA && (a.shape != b.shape || a.primitive != b.primitive))) {
                ++other;
                continue;
            }
            if (!inA) continue;
            ++met;
            const float slope = std::abs(dot(a.geometricNormal, ray.direction));
            ASSERT_LE(length(a.position - b.position) * slope, 4 * (a.offset + b.offset)) << i;
            EXPECT_NEAR(dot(a.geometricNormal, b.geometricNormal), 1.0f, 2e-5f);
            EXPECT_NEAR(dot(a.shadingNormal, b.shadingNormal), 1.0f, 2e-4f);
            EXPECT_EQ(a.material, b.material);
        }
        EXPECT_GT(met, 1000);
        EXPECT_LT(other, met / 100) << "at edges only";
    }
}

// What starts on a convex body and leads away from it does not meet it, however it was placed.
TEST(Instances, AreLeftByRaysThatStartOnThem) {
    // Flattened along an axis that is none of its own: the worse float's transforms are.
    for (const double flat : {1.0, 0.2}) {
        const Mesh mesh = ball(6);
        SceneMaker maker;
        std::vector<Transform> places = anywhere(60, 1000, 0.02, 2);
        for (Transform& place : places)
            place = times(times(place, scaled({1, 1, flat})), turned(0.9));
        instances(maker, mesh, maker.diffuse(Rgb(0.5f)), places);
        const auto scene = maker.build();
        ASSERT_TRUE(scene->hasInstances());
        Draws random(1, 0, 0, 0);
        int left = 0;
        for (int i = 0; i < 400'000; ++i) {
            Surface surface, again;
            if (!scene->intersect(somewhere(*scene, random), surface)) continue;
            const Vec3f way =
                Frame(surface.geometricNormal).toWorld(sampleCosineHemisphere(random.next2D()));
            ++left;
            if (!scene->intersect(rayFrom(surface, way), again)) continue;
            ASSERT_FALSE(again.shape == surface.shape && again.primitive == surface.primitive)
                << "ray " << i;
        }
        EXPECT_GT(left, 10'000);
    }
}

// A floor of tiles, turned as a whole: through no seam a ray passes, be it ever so near to it.
TEST(Instances, LeaveNoCracksWhereTheyTouch) {
    constexpr int kTiles = 16;
    SceneMaker maker;
    const Transform whole = times(moved({3, -7, 11}), turned(0.7));
    std::vector<Transform> places;
    for (int i = 0; i < kTiles; ++i)
        for (int j = 0; j < kTiles; ++j)
            places.push_back(times(whole, moved({1.0 * i, 1.0 * j, 0})));
    instances(maker, tile(3), maker.diffuse(Rgb(0.5f)), places);
    const auto scene = maker.build();
    ASSERT_TRUE(scene->hasInstances());
    Draws random(1, 0, 0, 0);
    const Vec3d up = Vec3d{whole[2], whole[6], whole[10]};
    for (int i = 0; i < 400'000; ++i) {
        const Vec2f u = random.next2D(), v = random.next2D();
        // Within some roundings of an inner seam.
        const double across = 1 + std::floor(static_cast<double>(u.x) * (kTiles - 1));
        const double aside = (static_cast<double>(random.next1D()) - 0.5) * 4e-6;
        const double along = 0.01 + static_cast<double>(u.y) * (kTiles - 0.02);
        const Vec3d at = i % 2 ? Vec3d{across + aside, along, 0} : Vec3d{along, across + aside, 0};
        const Vec3d on = transformPoint(whole, at) - scene->centre();
        const Vec3d from = on + up * 2.0 + Vec3d(sampleUniformSphere(v));
        const Vec3f start(from);
        Surface surface;
        ASSERT_TRUE(scene->intersect({start, Vec3f(on) - start}, surface)) << "ray " << i;
        ASSERT_TRUE(scene->occluded({start, (Vec3f(on) - start) * 2.0f, 1.0f})) << "ray " << i;
    }
}

TEST(Instances, AreInMemoryOnce) {
    const Mesh mesh = ball(60);
    const auto bytesOf = [&](std::size_t count) {
        SceneMaker maker;
        instances(maker, mesh, maker.diffuse(Rgb(0.5f)), anywhere(count, 100, 0.5, 2));
        return maker.build()->memoryBytes();
    };
    const std::uint64_t two = bytesOf(2), thousand = bytesOf(1000);
    EXPECT_GT(two, mesh->triangles.size() * 60);
    EXPECT_LT(thousand - two, 998 * 2048);
    EXPECT_LT(thousand, 3 * two);
}

// However unlike its places are, all share what was built.
TEST(Instances, ShareOneStructureWhateverTheirScales) {
    const Mesh mesh = ball(8);
    SceneMaker maker;
    std::vector<Transform> places;
    for (int i = 0; i < 40; ++i) {
        const double scale = std::pow(10.0, 2 - i % 5);
        places.push_back(times(moved({300.0 * i, 0, 0}), scaled({scale, scale, scale})));
    }
    instances(maker, mesh, maker.diffuse(Rgb(0.5f)), places);
    const auto scene = maker.build();
    ASSERT_TRUE(scene->hasInstances());
    const auto kept = mesh->rayTracing.get<SharedMesh>(
        [](const SharedMesh&) { return true; }, [] { return std::shared_ptr<const SharedMesh>(); });
    // By each instance, the mesh and here.
    EXPECT_EQ(kept.use_count(), 42);
}

// A new scene of the same meshes, with other places and lights, builds none of them again.
TEST(Instances, AreBuiltOnceForAllScenes) {
    const Mesh mesh = ball(8);
    const auto kept = [&] {
        return mesh->rayTracing.get<SharedMesh>([](const SharedMesh&) { return true; },
                                                [] { return std::shared_ptr<const SharedMesh>(); });
    };
    SceneMaker maker = manyBalls(mesh, 10);
    const auto before = maker.build();
    const auto first = kept();
    ASSERT_TRUE(first);
    maker.pointLight({0, 0, 20}, Rgb(1.0f));
    for (InstanceDescription& instance : maker.description.instances)
        instance.transform = times(moved({0.5, 0, 1}), instance.transform);
    const auto after = maker.build();
    EXPECT_EQ(kept(), first);
    Surface surface;
    EXPECT_TRUE(before->intersect({{-20, 0, 0}, {1, 0, 0}}, surface) ||
                after->intersect({{-20, 0, 0}, {1, 0, 0}}, surface));
    // A copy that is then changed starts anew.
    TriangleMesh copy = *mesh;
    EXPECT_FALSE(
        copy.rayTracing.get<SharedMesh>([](const SharedMesh&) { return true; },
                                        [] { return std::shared_ptr<const SharedMesh>(); }));
}

// Lamps among them shine from each of their places.
TEST(Instances, ShineWhereTheyAre) {
    const Mesh mesh = tile(8);
    SceneMaker maker;
    maker.quad({-2, -2, 0}, {4, 0, 0}, {0, 4, 0}, maker.diffuse(Rgb(0.5f)));
    std::vector<Transform> places;
    for (int i = 0; i < 36; ++i)
        places.push_back(times(moved({(i % 6) - 2.5, i / 6 - 2.5, 1.5}),
                               Transform{0.2, 0, 0, 0, 0, -0.2, 0, 0, 0, 0, -0.2, 0}));
    instances(maker, mesh, maker.diffuse({}, Rgb(2.0f)), places);
    maker.camera({0, -1, 1}, {0, 0, 0}, {0, 0, 1}, 60);
    const auto scene = maker.build(), flat = flattened(maker).build();
    ASSERT_TRUE(scene->hasInstances());
    ASSERT_EQ(scene->lights().size(), 36u * mesh->triangles.size());
    EXPECT_EQ(scene->lights().size(), flat->lights().size());
    const RenderSettings settings = smallFrame(16, 16, IntegratorKind::kPhoton, 8, 2);
    const MeasuredLayers a = measure(scene, settings), b = measure(flat, settings);
    EXPECT_TRUE(agree(a.direct, b.direct, 1e-4));
    EXPECT_TRUE(agree(a.indirect, b.indirect, 0.01));
    EXPECT_TRUE(agree(a.emission, b.emission, 1e-4));
}

TEST(Instances, LetLightThroughOnce) {
    MaterialDescription half;
    half.diffuse = Rgb(0.5f);
    half.transparency = 0.5f;
    SceneMaker maker;
    std::vector<Transform> places;
    for (int i = 0; i < 300; ++i) places.push_back(times(turned(0.4), moved({0, 0, 0.1 * i})));
    instances(maker, tile(3), maker.material(half), places);
    const auto scene = maker.build();
    ASSERT_TRUE(scene->hasInstances());
    const auto at = [&](double x, double y, double z) {
        return Vec3f(transformPoint(turned(0.4), {x, y, z}) - scene->centre());
    };
    for (const double x : {0.4, 1.0 / 3, 1e-7}) {
        const Vec3f from = at(x, 0.3, 0.05), to = at(x, 0.3, 0.35);
        EXPECT_EQ(scene->transmittance({from, to - from, 1.0f}).g, 0.125f) << x;
    }
}

}  // namespace
}  // namespace pm::test
