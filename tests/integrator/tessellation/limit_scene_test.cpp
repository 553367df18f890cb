// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Rays among limit surfaces that are cut when they are met.
#include "tests/support/limit_scene.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <tbb/parallel_for.h>

#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <vector>

#include "integrator/geometry/subdivision.h"
#include "integrator/sampling/warps.h"
#include "tests/integrator/geometry/obj_cage.h"
#include "tests/support/draws.h"

namespace pm::test {
namespace {

// From around the scene, into it.
Ray rayInto(const Scene& scene, Draws& random) {
    const auto radius = static_cast<float>(scene.radius());
    const Vec3f from = sampleUniformSphere(random.next2D()) * (2.0f * radius);
    const Vec3f to = sampleUniformSphere(random.next2D()) * (0.7f * radius * random.next1D());
    return {from, normalize(to - from)};
}

SceneMaker onDemand(SubdivisionCage cage, std::uint32_t rate) {
    SceneMaker maker;
    addLimit(maker, std::move(cage), rate, maker.diffuse(Rgb(0.5f)));
    return maker;
}

// The same surfaces as a plain mesh of the same rate, but for how its quads are halved.
TEST(LimitScene, IsMetWhereThePlainMeshIs) {
    const auto scene = onDemand(cubeCage(), 8).build();
    SceneMaker plain;
    plain.mesh(tessellate(cubeCage(), 8).mesh, plain.diffuse(Rgb(0.5f)));
    const auto other = plain.build();
    Draws random(3, 0, 0, 0);
    int met = 0, unlike = 0;
    for (int i = 0; i < 20'000; ++i) {
        Ray ray = rayInto(*scene, random);
        const Vec3f shift(scene->centre() - other->centre());
        Surface a, b;
        const bool meetsA = scene->intersect(ray, a);
        ray.origin += shift;
        const bool meetsB = other->intersect(ray, b);
        unlike += meetsA != meetsB;
        if (!meetsA || !meetsB) continue;
        ++met;
        ASSERT_LT(length(a.position + shift - b.position), 0.02f);
        ASSERT_GT(dot(a.geometricNormal, b.geometricNormal), 0.9f);
        ASSERT_GT(dot(a.shadingNormal, b.shadingNormal), 0.999f);
    }
    EXPECT_GT(met, 10'000);
    EXPECT_LT(unlike, 50);
}

struct Met {
    std::uint32_t primitive;
    Vec3f position, normal;
    bool operator==(const Met&) const = default;
};

std::vector<Met> metBy(const Scene& scene, std::uint32_t seed, int count) {
    std::vector<Met> all;
    Draws random(seed, 0, 0, 0);
    for (int i = 0; i < count; ++i) {
        Surface surface;
        const Ray ray = rayInto(scene, random);
        if (!scene.intersect(ray, surface)) continue;
        all.push_back({surface.primitive, surface.position, surface.shadingNormal});
        EXPECT_TRUE(scene.occluded(ray));
    }
    return all;
}

// A cache that holds next to nothing, and eight threads at once, change no bit.
TEST(LimitScene, IsTheSameBitsFromACacheTooSmall) {
    const auto large = onDemand(gridCage(24), 12).build(),
               small = onDemand(gridCage(24), 12).build();
    small->setGroupBudget(100'000);
    constexpr int kRays = 1000;
    std::array<std::vector<Met>, 8> fromLarge, fromSmall;
    tbb::parallel_for(0, 8, [&](int i) {
        const auto at = static_cast<std::size_t>(i);
        fromSmall[at] = metBy(*small, static_cast<std::uint32_t>(i), kRays);
    });
    for (std::size_t i = 0; i < 8; ++i) {
        fromLarge[i] = metBy(*large, static_cast<std::uint32_t>(i), kRays);
        EXPECT_GT(fromLarge[i].size(), 100u);
        EXPECT_TRUE(fromLarge[i] == fromSmall[i]) << i;
    }
    EXPECT_EQ(large->groupCounts().madeAgain, 0u);
    EXPECT_GT(small->groupCounts().madeAgain, 100u);
    // What is pinned, and one more for each thread, may be over.
    EXPECT_LT(small->groupCounts().mostBytesHeld, 100'000u + 16 * 90'000u);
}

TEST(LimitScene, CutsNothingThatNoRayMeets) {
    const auto scene = onDemand(gridCage(64), 8).build();
    EXPECT_EQ(scene->groupCounts().misses, 0u);
    const Vec3f down{0, 0, -1};
    Surface surface;
    ASSERT_TRUE(scene->intersect({{10.3f, 4.1f, 5}, down}, surface));
    EXPECT_EQ(scene->groupCounts().misses, 1u);
    EXPECT_GT(scene->groupCounts().bytesHeld, 10'000u);
}

TEST(LimitScene, TellsForWhomItCut) {
    const auto scene = onDemand(gridCage(64), 8).build();
    Surface surface;
    const CacheWatch::As as(CacheUser::kGather);
    ASSERT_TRUE(scene->intersect({{10.3f, 4.1f, 5}, {0, 0, -1}}, surface));
    ASSERT_TRUE(scene->occluded({{-10.3f, 4.1f, 5}, {0, 0, -1}}));
    EXPECT_EQ(scene->transmittance({{-10.3f, -14.1f, 5}, {0, 0, -1}}), Rgb(0.0f));
    const CacheCounts counts = scene->groupCounts();
    using Misses = std::array<std::uint64_t, kCacheUsers>;
    EXPECT_EQ(counts.missesOf, (Misses{0, 2, 0, 1, 0}));
    EXPECT_EQ(counts.misses, 3u);
}

// What rays from inside of a closed shape miss. The closest a ray can aim: at corners of triangles,
// where most of them meet.
std::size_t missedFromInside(const Scene& scene, std::uint64_t rays) {
    std::atomic<std::size_t> missed{0};
    constexpr std::uint64_t kBatch = 4096;
    tbb::parallel_for(std::uint64_t{0}, (rays + kBatch - 1) / kBatch, [&](std::uint64_t batch) {
        Draws random(static_cast<std::uint32_t>(batch), 1, 0, 0);
        for (std::uint64_t i = 0; i < kBatch; ++i) {
            const Vec3f from = sampleUniformSphere(random.next2D()) *
                               (0.05f * static_cast<float>(scene.radius()) * random.next1D());
            Vec3f way = sampleUniformSphere(random.next2D());
            RayHit hit;
            Surface surface;
            if (!scene.intersect({from, way}, surface)) {
                ++missed;
                continue;
            }
            if (i % 2 == 0) continue;
            // Again towards a corner of what it met.
            const Vec3f corner = surface.position;
            way = normalize(corner - from);
            if (!scene.intersect({from, way}, surface)) ++missed;
        }
    });
    return missed;
}

std::uint64_t raysOfCrackTest() {
    const char* const asked = std::getenv("PM_TEST_CRACK_RAYS");
    return asked ? std::strtoull(asked, nullptr, 10) : 40'000;
}

// PM_TEST_CRACK_RAYS: how many; 10 million are what the renderer is held to.
TEST(LimitScene, HasNoCracks) {
    const Transform far{1e4, 0, 0, 1e6, 0, 1e4, 0, 1e6, 0, 0, 1e4, -1e6};
    for (const Transform& place : {kIdentityTransform, far}) {
        for (const bool isBilinear : {false, true}) {
            SubdivisionCage cage = cubeCage();
            if (isBilinear) cage.scheme = SubdivisionScheme::kBilinear;
            SceneMaker maker;
            addLimit(maker, cage, 0, maker.diffuse(Rgb(0.5f)), place);
            const double size = place[0];
            maker.camera(Vec3d{place[3], place[7], place[11]} + Vec3d{4, 3, 2.4} * size,
                         {place[3], place[7], place[11]}, {0, 1, 0}, 40);
            EXPECT_EQ(missedFromInside(*maker.build(), raysOfCrackTest()), 0u)
                << isBilinear << " " << size;
        }
    }
}

// A height for each place, of any texture coordinates.
class WavyTexture final : public TextureSource {
  public:
    Texel lookUp(std::int32_t, const TextureContext& at) const override {
        const Vec2f uv = at.uv;
        const float height = 0.5f + 0.5f * std::sin(400.0f * uv.x) * std::cos(300.0f * uv.y);
        return {height, height, height};
    }
    std::array<std::uint32_t, 2> texels(std::int32_t) const override { return {4096, 4096}; }
    std::uint64_t failureCount() const override { return 0; }
};

// PM_TEST_MANY_TRIANGLES=1: fifty millions of them, displaced, all of which are cut, within 2 GiB;
// else a hundredth, and of the memory alone what the cache holds.
TEST(LimitScene, RendersManyTrianglesInLittleMemory) {
    const bool isMany = std::getenv("PM_TEST_MANY_TRIANGLES") != nullptr;
    const int side = isMany ? 400 : 40;
    SubdivisionCage cage = gridCage(side);
    for (const Vec3f& p : cage.mesh.positions)
        cage.mesh.texcoords.emplace_back(p.x / static_cast<float>(side),
                                         p.y / static_cast<float>(side));
    cage.mesh.texcoordIndices.assign(cage.mesh.vertexIndices.begin(),
                                     cage.mesh.vertexIndices.end());
    SceneMaker maker;
    maker.description.textures = std::make_shared<const WavyTexture>();
    MaterialDescription hills;
    hills.diffuse = Rgb(0.5f);
    hills.displacementTexture = 0;
    addLimit(maker, std::move(cage), 13, maker.material(hills));
    const double middle = 0.5 * side;
    maker.sky(Rgb(1.0f));
    maker.camera({middle, middle, 1.1 * side}, {middle, middle, 0}, {0, 1, 0}, 50);
    const auto scene = maker.build();
    EXPECT_GT(scene->groupBytes(), isMany ? 2'000'000'000u : 20'000'000u);
    scene->setGroupBudget(scene->groupBytes() / 16);
    RenderSettings settings = smallFrame(1024, 1024, IntegratorKind::kPath, 1, 2);
    if (!isMany) settings = smallFrame(32, 32, IntegratorKind::kPath, 1, 2);
    // Hills under an even sky: some of it is hidden.
    const MeasuredLayers measured = measure(scene, settings);
    EXPECT_GT(measured.beauty.mean[1], 0.2);
    EXPECT_LT(measured.beauty.mean[1], 0.55);
    const CacheCounts counts = scene->groupCounts();
    EXPECT_GT(counts.misses - counts.madeAgain, scene->groupBytes() / 100'000);
    EXPECT_GT(counts.madeAgain, 0u);
    EXPECT_LT(counts.mostBytesHeld, scene->groupBudget() + 16 * 90'000u);
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    RecordProperty("residentMiB", static_cast<int>(usage.ru_maxrss / 1024));
    EXPECT_LT(usage.ru_maxrss, isMany ? 2L << 20 : 1L << 40);  // KiB
}

TEST(LimitScene, LimitSurfacesThatShineAreCutWhole) {
    SceneMaker maker;
    addLimit(maker, cubeCage(), 4, maker.diffuse(Rgb(0.5f), Rgb(1.0f)));
    const auto scene = maker.build();
    EXPECT_EQ(scene->lights().size(), 6u * 32u);
    EXPECT_EQ(scene->groupCounts().misses, 0u);
    EXPECT_EQ(scene->groupBudget(), 0u);
}

// Of a plane z = 0 of side x side faces; u and v grow along x and y from 0 to 1. The faces beyond
// the middle of x are of slot 1.
SubdivisionCage planeOfTwoSlots(int side) {
    SubdivisionCage cage = gridCage(side);
    cage.scheme = SubdivisionScheme::kBilinear;
    PolygonMesh& mesh = cage.mesh;
    const auto size = static_cast<float>(side);
    for (const Vec3f& p : mesh.positions) mesh.texcoords.emplace_back(p.x / size, p.y / size);
    mesh.texcoordIndices.assign(mesh.vertexIndices.begin(), mesh.vertexIndices.end());
    for (std::size_t face = 0; face < mesh.faceCount(); ++face) {
        float x = 0;
        for (std::size_t k = 0; k < 4; ++k)
            x += mesh.positions[mesh.vertexIndices[4 * face + k]].x / 4;
        mesh.faceMaterials.push_back(x > size / 2 ? 1 : 0);
    }
    return cage;
}

// Heights that grow with u, or are 1 everywhere.
class Slope final : public TextureSource {
  public:
    explicit Slope(float ofU) : m_ofU(ofU) {}
    Texel lookUp(std::int32_t, const TextureContext& at) const override {
        const Vec2f uv = at.uv;
        const float height = 1.0f - m_ofU * (1.0f - uv.x);
        return {height, height, height};
    }
    std::array<std::uint32_t, 2> texels(std::int32_t) const override { return {64, 64}; }
    std::uint64_t failureCount() const override { return 0; }

  private:
    float m_ofU;
};

constexpr float kHeight = 0.5f;

// The first slot dark, the second shining with radiance 1; both displaced by kHeight.
void addHalfShining(SceneMaker& maker, SubdivisionCage cage, std::uint32_t rate,
                    const Transform& place = kIdentityTransform) {
    MaterialDescription material;
    material.displacementTexture = 0;
    material.displacementScale = kHeight;
    const std::uint32_t dark = maker.material(material);
    material.emission = Rgb(1.0f);
    const std::uint32_t shining = maker.material(material);
    addLimit(maker, std::move(cage), rate, dark, place);
    maker.description.instances.back().materials = {dark, shining};
}

TEST(LimitScene, IsDisplacedWhereItShinesAndBesideThat) {
    SceneMaker maker;
    maker.description.textures = std::make_shared<const Slope>(1.0f);
    addHalfShining(maker, planeOfTwoSlots(4), 3);
    const auto scene = maker.build();
    EXPECT_EQ(scene->lights().size(), 8u * 18u);
    double area = 0;
    for (const Light& light : scene->lights()) area += static_cast<double>(light.surface()->area);
    EXPECT_NEAR(area, 8.0 * std::hypot(1.0, kHeight / 4.0), 1e-5);
    for (const Notice& notice : scene->notices()) ADD_FAILURE() << notice.text;
    const Vec3f centre(scene->centre());
    for (int i = 0; i < 400; ++i) {
        const float x = 0.00737f + 0.01f * static_cast<float>(i);
        Surface surface;
        ASSERT_TRUE(scene->intersect({Vec3f{x, 1.3f, 5} - centre, {0, 0, -1}}, surface)) << x;
        EXPECT_NEAR(surface.position.z + centre.z, kHeight * x / 4.0f, 1e-6) << x;
        EXPECT_EQ(isBlack(scene->emission(surface.material, surface.uv)), x < 2.0f) << x;
        EXPECT_NEAR(surface.uv.x, x / 4.0f, 1e-5);
    }
    // The dark half alone is cut on demand.
    EXPECT_EQ(scene->groupCounts().misses, 1u);
}

// Of a point above the middle of a square lamp of which one half shines: by the integral over a
// rectangle with a corner below the point (form factor of parallel rectangles).
TEST(LimitScene, LightsFromWhereItIsDisplacedTo) {
    constexpr double kPi = 3.14159265358979323846, kAbove = 3.0;
    const double a = 2.0 / (kAbove - kHeight);
    const double formFactor =
        4.0 / kPi * a / std::hypot(1.0, a) * std::atan(a / std::hypot(1.0, a));
    const Transform mirrored{-1, 0, 0, 4, 0, 1, 0, 0, 0, 0, 1, 0};
    for (const Transform& place : {kIdentityTransform, mirrored}) {
        SceneMaker maker;
        maker.description.textures = std::make_shared<const Slope>(0.0f);
        addHalfShining(maker, planeOfTwoSlots(4), 3, place);
        maker.quad({1.9, 1.9, kAbove}, {0, 0.2, 0}, {0.2, 0, 0}, maker.diffuse(Rgb(0.5f)));
        maker.camera({2, 2, 1}, {2, 2, kAbove}, {0, 1, 0}, 0.5);
        const auto scene = maker.build();
        const MeasuredLayers seen = measure(scene, smallFrame(8, 8, IntegratorKind::kPath, 16, 2));
        EXPECT_TRUE(agrees(seen.beauty, Rgb(static_cast<float>(0.5 * formFactor / 2)), 1e-3));
        EXPECT_GT(seen.beauty.mean[0], 0.05);
    }
}

// Rays through the line where the two meet, to either side of it by up to a millionth of a face.
TEST(LimitScene, HasNoCracksBesideWhatShines) {
    const Transform far{1e4, 0, 0, 1e6, 0, 1e4, 0, 1e6, 0, 0, 1e4, -1e6};
    const Transform mirrored{-1, 0, 0, 0.1, 0, 1, 0, 0.2, 0, 0, 1, 0.3};
    for (const Transform& place : {kIdentityTransform, far, mirrored}) {
        SceneMaker maker;
        maker.description.textures = std::make_shared<const WavyTexture>();
        addHalfShining(maker, planeOfTwoSlots(4), 0, place);
        const double size = std::abs(place[0]);
        for (std::uint32_t m = 0; m < 2; ++m)
            maker.description.materials[m].displacementScale = static_cast<float>(0.1 * size);
        const Vec3d middle = transformPoint(place, {2, 2, 0});
        maker.camera(middle + Vec3d{0.4, 0.5, 4} * size, middle, {0, 1, 0}, 150);
        const auto scene = maker.build();
        EXPECT_GT(scene->lights().size(), 500u);
        Draws random(7, 0, 0, 0);
        for (int i = 0; i < 10'000; ++i) {
            const double y = 0.1 + 3.8 * static_cast<double>(random.next1D());
            const double aside = 2e-6 * static_cast<double>(random.next1D() - 0.5f);
            const Vec3f from(transformPoint(place, {2 + aside, y, 3}) - scene->centre());
            Surface surface;
            ASSERT_TRUE(scene->intersect({from, normalize(Vec3f{0, 0.03f, -1})}, surface))
                << size << " " << y << " " << aside;
        }
    }
}

}  // namespace
}  // namespace pm::test
