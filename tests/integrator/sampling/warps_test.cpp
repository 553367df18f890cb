// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Everything that is sampled against the density it states: chi-squared tests at one significance
// for all (Bonferroni), each kind with a twin whose density is wrong and must be refused.
#include "integrator/sampling/warps.h"

#include <gtest/gtest.h>

#include <cmath>

#include "integrator/light_sampling/light_sampler.h"
#include "integrator/materials/bsdf.h"
#include "tests/support/scene_maker.h"
#include "tests/support/statistics.h"

namespace pm::test {
namespace {

// 1 % for the whole file, shared among at most 40 tests.
constexpr double kSignificance = 0.01 / 40;
constexpr double kPiD = std::numbers::pi;

double z(const Vec3f& d) {
    return static_cast<double>(d.z);
}

// What rounding makes of walls along axes and diagonals turns no frame, nor the directions that are
// sampled in it; and every frame is one, close to where its sign changes too.
TEST(Warps, FramesDontJumpAtWalls) {
    constexpr float kRounding = 1e-7f;
    for (int x = -1; x <= 1; ++x)
        for (int y = -1; y <= 1; ++y)
            for (int z = -1; z <= 1; ++z) {
                if (x == 0 && y == 0 && z == 0) continue;
                const Vec3f wall(static_cast<float>(x), static_cast<float>(y),
                                 static_cast<float>(z));
                const Frame frame(normalize(wall));
                for (int i = 0; i < 8; ++i) {
                    const auto off = [&](int bit) {
                        return (i >> bit & 1) ? kRounding : -kRounding;
                    };
                    const Frame moved(normalize(wall + Vec3f(off(0), off(1), off(2))));
                    EXPECT_LT(length(moved.tangent - frame.tangent), 1e-6f) << x << y << z;
                    EXPECT_LT(length(moved.bitangent - frame.bitangent), 1e-6f) << x << y << z;
                }
            }
    Random random(4);
    for (int i = 0; i < 100000; ++i) {
        const Frame frame(sampleUniformSphere(random.next2D()));
        EXPECT_NEAR(dot(frame.tangent, frame.normal), 0, 1e-6);
        EXPECT_NEAR(dot(frame.bitangent, frame.normal), 0, 1e-6);
        EXPECT_NEAR(dot(frame.tangent, frame.bitangent), 0, 1e-6);
        EXPECT_NEAR(length(frame.tangent), 1, 1e-6);
        EXPECT_NEAR(length(frame.bitangent), 1, 1e-6);
    }
}

TEST(Warps, CosineHemisphere) {
    Random random(1);
    const auto sample = [&] { return sampleCosineHemisphere(random.next2D()); };
    const auto density = [](const Vec3f& d) { return std::max(0.0, z(d)) / kPiD; };
    EXPECT_GT(DirectionTest{}.pValue(sample, density), kSignificance);
    // Twin: a few per cent denser towards the pole.
    const auto wrong = [&](const Vec3f& d) { return density(d) * (1 + 0.2 * (z(d) - 2.0 / 3)); };
    EXPECT_LT(DirectionTest{}.pValue(sample, wrong), kSignificance);
}

TEST(Warps, UniformSphere) {
    Random random(2);
    const auto sample = [&] { return sampleUniformSphere(random.next2D()); };
    EXPECT_GT(DirectionTest{}.pValue(sample, [](const Vec3f&) { return 0.25 / kPiD; }),
              kSignificance);
    EXPECT_LT(
        DirectionTest{}.pValue(sample, [](const Vec3f& d) { return (1 + 0.1 * z(d)) / 4 / kPiD; }),
        kSignificance);
}

TEST(Warps, UniformCone) {
    Random random(3);
    for (const float oneMinusCos : {1.5f, 0.1f, 1e-4f}) {
        DirectionTest test;
        test.smallestCosine = 1 - static_cast<double>(oneMinusCos);
        test.cosineBins = oneMinusCos < 1e-3f ? 4 : 16;  // what a float's cosine can tell apart
        const auto sample = [&] { return sampleUniformCone(random.next2D(), oneMinusCos); };
        const double density = 0.5 / kPiD / static_cast<double>(oneMinusCos);
        EXPECT_GT(test.pValue(sample, [&](const Vec3f&) { return density; }), kSignificance);
        EXPECT_LT(test.pValue(sample, [&](const Vec3f&) { return density * 0.98; }), kSignificance);
    }
}

TEST(Warps, PhongLobe) {
    Random random(4);
    for (const float exponent : {0.0f, 1.0f, 7.5f, 60.0f}) {
        DirectionTest test;
        test.smallestCosine = exponent > 20 ? 0.8 : 0.0;
        const auto n = static_cast<double>(exponent);
        const auto sample = [&] { return samplePhongLobe(random.next2D(), exponent); };
        const auto density = [](double e) {
            return [e](const Vec3f& d) { return (e + 1) / (2 * kPiD) * std::pow(z(d), e); };
        };
        EXPECT_GT(test.pValue(sample, density(n)), kSignificance) << exponent;
        EXPECT_LT(test.pValue(sample, density(n * 1.05 + 0.05)), kSignificance) << exponent;
    }
}

TEST(Warps, Triangle) {
    Random random(5);
    // (b1, b2 / (1 - b1)) covers the unit square; the area is 2 (1 - b1) of it.
    const auto sample = [&]() -> std::optional<Vec2f> {
        const Vec2f b = sampleTriangle(random.next2D());
        if (b.x < 0.0f || b.y < 0.0f || b.x + b.y > 1.0f + 1e-6f) return std::nullopt;
        return Vec2f{b.x, b.x < 1.0f ? b.y / (1.0f - b.x) : 0.0f};
    };
    EXPECT_GT(squarePValue(200'000, sample, [](double b1, double) { return 2 * (1 - b1); }),
              kSignificance);
    EXPECT_LT(squarePValue(200'000, sample, [](double b1, double) { return 2.1 * (1 - b1) - .05; }),
              kSignificance);
}

// One surface of a material, seen along `out`.
struct Bench {
    SceneMaker maker;
    std::shared_ptr<const Scene> scene;
    Surface surface;

    Bench(const MaterialDescription& material, Vec3f shadingNormal) {
        maker.quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, maker.material(material));
        scene = maker.build();
        surface.geometricNormal = {0, 0, 1};
        surface.shadingNormal = normalize(shadingNormal);
    }
};

double lobePValue(const Bench& bench, const Bsdf& bsdf, Lobe lobe, double densityFactor,
                  std::uint64_t seed) {
    Random random(seed);
    DirectionTest test;
    const auto inside = [&](const Vec3f& d) {
        const bool isAbove = d.z > 0.0f;
        return (isAbove || bsdf.goesThrough()) &&
               isAbove == (dot(d, bench.surface.shadingNormal) > 0.0f);
    };
    return test.pValue(
        [&]() -> std::optional<Vec3f> {
            BsdfSample sample;
            const float uLobe = random.next();
            if (!bsdf.sample(uLobe, random.next2D(), sample) || sample.lobe != lobe)
                return std::nullopt;
            return sample.direction;
        },
        [&](const Vec3f& d) {
            if (!inside(d)) return 0.0;
            return static_cast<double>(bsdf.pdfSolidAngle(lobe, d)) *
                   (1 + densityFactor * (z(d) - 0.5));
        });
}

// Each lobe of diffuse, glossy and mixed materials, for radiance and for photons (which are
// absorbed too), straight and tilted shading normals.
TEST(Warps, BsdfSamplesItsDensity) {
    MaterialDescription mixed;
    mixed.diffuse = {0.5f, 0.3f, 0.2f};
    mixed.glossy = {0.2f, 0.3f, 0.3f};
    mixed.glossyExponent = 12;
    MaterialDescription diffuse = mixed, glossy = mixed;
    diffuse.glossy = {};
    glossy.diffuse = {};
    std::uint64_t seed = 100;
    for (const MaterialDescription& material : {diffuse, glossy, mixed})
        for (const Transport transport : {Transport::kRadiance, Transport::kPhotons}) {
            const Bench bench(material, {0, 0, 1});
            const Vec3f out = normalize(Vec3f{0.6f, 0.3f, 0.5f});
            const Bsdf bsdf(bench.scene->materials(), bench.surface, out, transport,
                            Rgb(0.7f, 1.0f, 0.4f));
            for (const Lobe lobe : {Lobe::kDiffuse, Lobe::kBroad}) {
                if (!bsdf.has(lobe)) continue;
                EXPECT_GT(lobePValue(bench, bsdf, lobe, 0.0, ++seed), kSignificance) << seed;
                EXPECT_LT(lobePValue(bench, bsdf, lobe, 0.6, ++seed), kSignificance) << seed;
            }
        }
}

// Rough metal, broad and narrow, by its colour and by n and k, rough glass from both sides, broad
// and narrow, a coat, plaster and a leaf.
TEST(Warps, RoughSurfacesSampleTheirDensity) {
    std::vector<MaterialDescription> materials(11);
    materials[0].kind = materials[1].kind = MaterialKind::kMirror;
    materials[0].glossy = materials[1].glossy = {0.9f, 0.8f, 0.5f};
    materials[0].roughness = 0.8f;
    materials[1].roughness = 0.6f;
    materials[2].kind = materials[3].kind = MaterialKind::kDielectric;
    materials[2].roughness = materials[3].roughness = 0.8f;
    materials[4].diffuse = Rgb(0.5f);
    materials[4].glossy = Rgb(0.3f);
    materials[4].roughness = 0.7f;
    materials[5].diffuse = Rgb(0.6f);
    materials[5].diffuseRoughness = 0.9f;
    materials[6].diffuse = Rgb(0.2f);
    materials[6].diffuseTransmission = Rgb(0.5f);
    for (std::size_t i = 7; i < 9; ++i) {
        materials[i] = materials[0];
        materials[i].roughness = 0.4f;
    }
    materials[8].conductorN = {0.14f, 0.37f, 1.44f};
    materials[8].conductorK = {3.98f, 2.38f, 1.6f};
    materials[9] = materials[10] = materials[2];
    materials[9].roughness = materials[10].roughness = 0.4f;
    std::uint64_t seed = 300;
    for (std::size_t i = 0; i < materials.size(); ++i)
        for (const Transport transport : {Transport::kRadiance, Transport::kPhotons}) {
            const Bench bench(materials[i], {0, 0, 1});
            const Vec3f out = normalize(Vec3f{0.6f, 0.3f, i == 3 || i == 10 ? -0.5f : 0.5f});
            const Bsdf bsdf(bench.scene->materials(), bench.surface, out, transport,
                            Rgb(0.7f, 1.0f, 0.4f));
            for (const Lobe lobe : {Lobe::kDiffuse, Lobe::kBroad, Lobe::kGlossy, Lobe::kWide}) {
                if (!bsdf.has(lobe)) continue;
                SCOPED_TRACE(testing::Message() << "material " << i);
                EXPECT_GT(lobePValue(bench, bsdf, lobe, 0.0, ++seed), kSignificance) << seed;
                EXPECT_LT(lobePValue(bench, bsdf, lobe, 0.9, ++seed), kSignificance) << seed;
            }
        }
}

TEST(Warps, BsdfSamplesItsDensityUnderATiltedNormal) {
    MaterialDescription diffuse;
    diffuse.diffuse = Rgb(0.5f);
    const Bench bench(diffuse, {0.3f, 0.1f, 1.0f});
    const Bsdf bsdf(bench.scene->materials(), bench.surface, normalize(Vec3f{0.1f, 0.3f, 0.8f}),
                    Transport::kRadiance, Rgb(1.0f));
    EXPECT_GT(lobePValue(bench, bsdf, Lobe::kDiffuse, 0.0, 1), kSignificance);
    EXPECT_LT(lobePValue(bench, bsdf, Lobe::kDiffuse, 0.15, 2), kSignificance);
}

}  // namespace
}  // namespace pm::test
