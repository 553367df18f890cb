// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Light sampling and photon emission against the densities and the flux they state.
#include "integrator/light_sampling/light_sampler.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/scene_maker.h"
#include "tests/support/statistics.h"

namespace pm::test {
namespace {

constexpr double kSignificance = 0.01 / 20;
constexpr double kPiD = std::numbers::pi;

// A floor under a light of two triangles and a sphere light.
struct Lamps {
    SceneMaker maker;
    std::shared_ptr<const Scene> scene;
    std::unique_ptr<LightSampler> lights;
    Surface floor;

    Lamps() {
        maker.quad({-5, -5, 0}, {10, 0, 0}, {0, 10, 0}, maker.diffuse(Rgb(0.5f)));
        maker.quad({-1, -1, 2}, {0, 2, 0.5}, {2, 0, 0}, maker.diffuse({}, {1, 2, 3}));  // down
        maker.sphere({3, 0, 1}, 0.7, maker.diffuse({}, {4, 1, 1}));
        scene = maker.build();
        lights = std::make_unique<LightSampler>(*scene);
        const Ray down{Vec3f(Vec3d{0.3, 0.2, 0.5} - scene->centre()), {0, 0, -1}};
        EXPECT_TRUE(scene->intersect(down, floor));
    }

    const Light& light(std::size_t i) const { return scene->lights()[i]; }

    // The surface that a direction from the floor meets on light `i`, if it does.
    bool meets(std::size_t i, const Vec3f& direction, Surface& on) const {
        return scene->intersect(rayFrom(floor, direction), on) &&
               on.light == static_cast<std::int32_t>(i);
    }
};

// Probability of each light: summed over its samples it is what sample() says it is.
TEST(LightSampler, ChoosesByTheProbabilitiesItStates) {
    const Lamps lamps;
    Random random(1);
    const int n = 100'000;
    std::array<double, 3> inverse{};
    std::array<double, 3> count{};
    LightSample sample;
    int missed = 0;
    for (int i = 0; i < n; ++i) {
        ASSERT_TRUE(lamps.lights->sample(lamps.floor, random.next2D(), sample));
        Surface on;
        if (!lamps.scene->intersect(rayFrom(lamps.floor, sample.direction), on) || on.light < 0) {
            ++missed;
            continue;
        }
        const float pdf = lamps.lights->pdfSolidAngle(lamps.floor, sample.direction, on);
        EXPECT_NEAR(pdf / sample.pdfSolidAngle, 1.0f, 2e-3f);
        EXPECT_FALSE(lamps.scene->occluded(sample.shadowRay));
        count[static_cast<std::size_t>(on.light)] += 1;
        inverse[static_cast<std::size_t>(on.light)] += 1 / static_cast<double>(pdf) / n;
    }
    EXPECT_LE(missed, 5);  // on a limb, where the ray's offset counts
    // E[1 / pdf] over a light is the solid angle it fills; of the sphere that is known.
    const Vec3d toCentre =
        lamps.scene->sphere(lamps.light(2).surface()->shape).centre - Vec3d(lamps.floor.position);
    const double sin2 = 0.49 / lengthSquared(toCentre);
    EXPECT_NEAR(inverse[2], 2 * kPiD * (1 - std::sqrt(1 - sin2)), 0.02 * inverse[2]);
    double power = 0;
    for (std::size_t i = 0; i < 3; ++i) power += lamps.light(i).powerMean;
    for (std::size_t i = 0; i < 3; ++i) {
        const double p = 0.1 / 3 + 0.9 * lamps.light(i).powerMean / power;
        EXPECT_NEAR(count[i] / n, p, 4 * std::sqrt(p * (1 - p) / n));
    }
}

TEST(LightSampler, SphereDensity) {
    const Lamps lamps;
    Random random(2);
    const Vec3d toCentre =
        lamps.scene->sphere(lamps.light(2).surface()->shape).centre - Vec3d(lamps.floor.position);
    DirectionTest test;
    test.axis = Vec3f(normalize(toCentre));
    test.smallestCosine = std::sqrt(1 - 0.49 / lengthSquared(toCentre));
    const auto sample = [&]() -> std::optional<Vec3f> {
        LightSample s;
        Surface on;
        if (!lamps.lights->sample(lamps.floor, random.next2D(), s) ||
            !lamps.meets(2, s.direction, on))
            return std::nullopt;
        return s.direction;
    };
    const auto density = [&](double tilt) {
        return [&, tilt](const Vec3f& d) {
            Surface on;
            if (!lamps.meets(2, d, on)) return 0.0;
            const auto cosine = static_cast<double>(dot(d, test.axis));
            return static_cast<double>(lamps.lights->pdfSolidAngle(lamps.floor, d, on)) *
                   (1 + tilt * (cosine - 0.98));
        };
    };
    test.subdivisions = 4;
    EXPECT_GT(test.pValue(sample, density(0)), kSignificance);
    EXPECT_LT(test.pValue(sample, density(5)), kSignificance);
}

// The record of a triangle that shines says what its shape, facet and light do, to the bit, and
// there is none of other lights. A huge one is intersected in double, and its vertices aren't
// rounded: of it there is none either.
TEST(LightSampler, TrianglesThatShineHaveTheirPoints) {
    SceneMaker maker;
    const auto lamp = maker.diffuse({}, {1, 2, 3});
    maker.quad({-1, -1, 2}, {0, 2, 0.5}, {2, 0, 0}, lamp);
    maker.meshSphere({3, 1, 2}, 0.4, maker.diffuse({}, {4, 1, 1}), false, 6);
    // Turned inside out by its transform.
    maker.description.instances.back().transform[0] = -1;
    maker.sphere({3, 0, 1}, 0.7, lamp);
    maker.pointLight({0, 0, 1}, Rgb(1.0f));
    maker.quad({-1e7, -1e7, -1}, {2e7, 0, 3e6}, {0, 2e7, 1e6}, lamp);
    const auto scene = maker.build();
    Random random(7);
    int triangles = 0, others = 0;
    for (std::size_t i = 0; i < scene->lights().size(); ++i) {
        const Light& light = scene->lights()[i];
        const LampTriangle& record = scene->lampTriangle(i);
        const SurfaceLight* const shining = light.surface();
        const bool isHuge = shining && shining->area > 1e6f;
        ASSERT_EQ(static_cast<bool>(record), shining && !light.wholeSphere(*scene) && !isHuge) << i;
        if (!record) {
            ++others;
            continue;
        }
        ++triangles;
        EXPECT_EQ(record.area, shining->area);
        EXPECT_EQ(record.material, shining->material);
        const Vec2f u = random.next2D();
        const LampPoint found = record.point(u);
        const Surface expected = scene->pointOnLight(light, u);
        EXPECT_EQ(found.position, expected.position);
        EXPECT_EQ(found.offset, expected.offset);
        EXPECT_EQ(found.normal, expected.geometricNormal);
    }
    EXPECT_GT(triangles, 100);
    EXPECT_EQ(others, 4);
}

// On a triangle by the point met, in (b1, b2/(1-b1)), so that no bin straddles its edge.
TEST(LightSampler, TriangleDensity) {
    const Lamps lamps;
    const std::size_t index = 1;
    // The corners from three points on the light.
    const Vec3d p0(lamps.scene->pointOnLight(lamps.light(index), {1, 0}).position);
    const Vec3d p1(lamps.scene->pointOnLight(lamps.light(index), {0, 0}).position);
    const Vec3d p2(lamps.scene->pointOnLight(lamps.light(index), {1, 1}).position);
    const Vec3d e1 = p1 - p0, e2 = p2 - p0, normal = cross(e1, e2);
    const double twiceArea = length(normal);
    Random random(3);
    const auto sample = [&]() -> std::optional<Vec2f> {
        LightSample s;
        Surface on;
        if (!lamps.lights->sample(lamps.floor, random.next2D(), s) ||
            !lamps.meets(index, s.direction, on))
            return std::nullopt;
        const Vec3d d = Vec3d(on.position) - p0;
        const double b1 = dot(cross(d, e2), normal) / lengthSquared(normal);
        const double b2 = dot(cross(e1, d), normal) / lengthSquared(normal);
        return Vec2f{static_cast<float>(b1), static_cast<float>(b2 / (1 - b1))};
    };
    const auto density = [&](double tilt) {
        return [&, tilt](double b1, double t) {
            Surface on;
            on.light = static_cast<std::int32_t>(index);
            on.position = Vec3f(p0 + e1 * b1 + e2 * (t * (1 - b1)));
            on.geometricNormal =
                lamps.scene->pointOnLight(lamps.light(index), {0.5f, 0.5f}).geometricNormal;
            const Vec3d toLight = Vec3d(on.position) - Vec3d(lamps.floor.position);
            const double d2 = lengthSquared(toLight);
            const Vec3f direction(toLight / std::sqrt(d2));
            const auto cosine = static_cast<double>(std::abs(dot(direction, on.geometricNormal)));
            return static_cast<double>(lamps.lights->pdfSolidAngle(lamps.floor, direction, on)) *
                   cosine / d2 * twiceArea * (1 - b1) * (1 + tilt * (b1 - 1.0 / 3));
        };
    };
    EXPECT_GT(squarePValue(200'000, sample, density(0)), kSignificance);
    EXPECT_LT(squarePValue(200'000, sample, density(0.4)), kSignificance);
}

TEST(LightSampler, EmitsItsFluxByTheCosine) {
    const Lamps lamps;
    Random random(4);
    const int n = 200'000;
    std::array<double, 3> mean{}, square{};
    const Vec3f normal = lamps.scene->pointOnLight(lamps.light(0), {0.5f, 0.5f}).geometricNormal;
    DirectionTest test;
    test.axis = normal;
    test.samples = n;
    const auto sample = [&]() -> std::optional<Vec3f> {
        EmittedPhoton photon;
        const float u = random.next();
        const Vec2f uPoint = random.next2D();
        if (!lamps.lights->emit(u, uPoint, random.next2D(), photon)) return std::nullopt;
        for (int c = 0; c < 3; ++c) {
            const auto f = static_cast<double>(photon.flux[c]);
            mean[static_cast<std::size_t>(c)] += f / n;
            square[static_cast<std::size_t>(c)] += f * f / n;
        }
        // The flat lamp's photons start in its plane; the sphere's are no part of this test.
        if (photon.flux.g < 1.5f * photon.flux.r) return std::nullopt;
        return photon.ray.direction;
    };
    double power = 0;
    for (std::size_t i = 0; i < 3; ++i) power += lamps.light(i).powerMean;
    const double share = 2 * (0.1 / 3) + 0.9 * (lamps.light(0).powerMean * 2) / power;
    EXPECT_GT(test.pValue(sample,
                          [&](const Vec3f& d) {
                              return share / kPiD *
                                     std::max(0.0, static_cast<double>(dot(d, normal)));
                          }),
              kSignificance);
    // pi A L of both lamps.
    const double flat = kPiD * 2 * std::hypot(2.0, 0.5), round = kPiD * 4 * kPiD * 0.49;
    const std::array<double, 3> expected = {flat + 4 * round, 2 * flat + round, 3 * flat + round};
    for (std::size_t c = 0; c < 3; ++c)
        EXPECT_NEAR(mean[c], expected[c], 4 * std::sqrt((square[c] - mean[c] * mean[c]) / n));
}

// A sphere light's photons leave every point of it by the cosine (hard cases P11).
TEST(LightSampler, SphereEmitsByTheCosine) {
    SceneMaker maker;
    maker.sphere({0, 0, 0}, 1, maker.diffuse({}, Rgb(1.0f)));
    const auto scene = maker.build();
    const LightSampler lights(*scene);
    Random random(5);
    double cosine = 0, cosine2 = 0;
    Vec3d direction;
    const int n = 100'000;
    for (int i = 0; i < n; ++i) {
        EmittedPhoton photon;
        const Vec2f uPoint = random.next2D();
        ASSERT_TRUE(lights.emit(random.next(), uPoint, random.next2D(), photon));
        const auto c = static_cast<double>(dot(photon.ray.origin, photon.ray.direction));
        cosine += c / n;
        cosine2 += c * c / n;
        direction += Vec3d(photon.ray.direction) / n;
    }
    // analytic F6: 2/3 and 1/2, and no direction preferred.
    EXPECT_NEAR(cosine, 2.0 / 3, 4 * std::sqrt((0.5 - 4.0 / 9) / n));
    EXPECT_NEAR(cosine2, 0.5, 4 * std::sqrt(1.0 / 12 / n));
    EXPECT_LT(length(direction), 5 * std::sqrt(1.0 / n));
}

// Tiny, far and edge-on lights: finite or refused, never NaN (hard cases G5).
TEST(LightSampler, ExtremeTrianglesAreFinite) {
    for (const double size : {1e-5, 1e-9}) {
        SceneMaker maker;
        maker.quad({-5, -5, 0}, {10, 0, 0}, {0, 10, 0}, maker.diffuse(Rgb(0.5f)));
        const auto lamp = maker.diffuse({}, Rgb(541127.0f));
        maker.quad({0, 0, 1}, {0, size, 0}, {size, 0, 0}, lamp);  // small
        maker.quad({0, 0, 0}, {0, 0, 1}, {0, 1, 0}, lamp);        // edge-on
        const auto scene = maker.build();
        const LightSampler lights(*scene);
        Surface floor;
        ASSERT_TRUE(
            scene->intersect({Vec3f(Vec3d{0, 0.5, 0.5} - scene->centre()), {0, 0, -1}}, floor));
        floor.position.x = Vec3f(-scene->centre()).x;  // in the lamp's own plane
        Random random(6);
        for (int i = 0; i < 10'000; ++i) {
            LightSample s;
            if (!lights.sample(floor, random.next2D(), s)) continue;
            EXPECT_TRUE(isFinite(s.direction) && isFinite(s.radiance * (1 / s.pdfSolidAngle)));
            EXPECT_GT(s.pdfSolidAngle, 0.0f);
        }
    }
}

}  // namespace
}  // namespace pm::test
