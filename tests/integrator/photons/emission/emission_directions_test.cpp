// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// What leaves lamps: directions and points, unaimed and aimed, against their densities, and aimed
// photons against the lamp's flux, bin by bin. Each with a twin that must be refused.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include "integrator/light_sampling/light_sampler.h"
#include "integrator/photons/emission/aimed_emission.h"
#include "integrator/photons/trace/photon_tracer.h"
#include "tests/support/rooms.h"
#include "tests/support/scene_maker.h"
#include "tests/support/statistics.h"

namespace pm::test {
namespace {

// 1 % for the whole file, shared among at most 30 tests.
constexpr double kSignificance = 0.01 / 30;
constexpr double kPiD = std::numbers::pi;

// One lamp of any kind, and photons that leave it unaimed.
struct Lamp {
    std::shared_ptr<const Scene> scene;
    LightSampler lights;
    Random random{3};

    explicit Lamp(const SceneMaker& maker) : scene(maker.build()), lights(*scene) {}
    Ray photon() {
        EmittedPhoton photon;
        const float u = random.next();
        const Vec2f uPoint = random.next2D();
        EXPECT_TRUE(lights.emit(u, uPoint, random.next2D(), photon));
        return photon.ray;
    }
};

// Points of a sphere lamp evenly, directions by the cosine about the normal there.
TEST(EmissionDirections, OfASphereLamp) {
    SceneMaker maker;
    maker.sphere({0, 0, 0}, 1, maker.diffuse({}, Rgb(1.0f)));
    Lamp lamp(maker);
    const auto point = [&] { return normalize(lamp.photon().origin); };
    const auto even = [](const Vec3f&) { return 0.25 / kPiD; };
    const auto tilted = [](const Vec3f& d) {
        return 0.25 / kPiD * (1 + 0.1 * static_cast<double>(d.x));
    };
    EXPECT_GT(DirectionTest{}.pValue(point, even), kSignificance);
    EXPECT_LT(DirectionTest{}.pValue(point, tilted), kSignificance);
    const auto direction = [&] {
        const Ray ray = lamp.photon();
        const Frame frame(normalize(ray.origin));
        return Vec3f{dot(ray.direction, frame.tangent), dot(ray.direction, frame.bitangent),
                     dot(ray.direction, frame.normal)};
    };
    const auto cosine = [](const Vec3f& d) {
        return std::max(0.0, static_cast<double>(d.z)) / kPiD;
    };
    // Twin: the cosine is lost.
    const auto flat = [](const Vec3f& d) { return d.z > 0.0f ? 0.5 / kPiD : 0.0; };
    EXPECT_GT(DirectionTest{}.pValue(direction, cosine), kSignificance);
    EXPECT_LT(DirectionTest{}.pValue(direction, flat), kSignificance);
}

// A point light inside the scene fills the sphere of directions, one outside the cone that holds
// the scene.
TEST(EmissionDirections, OfAPointLight) {
    for (const double distance : {0.5, 6.0}) {
        SceneMaker maker;
        maker.box({-1, -1, -1}, {1, 1, 1}, maker.diffuse(Rgb(0.5f)), true);
        const Vec3d at = normalize(Vec3d{1, 2, -1}) * distance;
        maker.pointLight(at, Rgb(1.0f));
        Lamp lamp(maker);
        DirectionTest test;
        test.axis = Vec3f(normalize(-at));
        const double radius = lamp.scene->radius();
        // The cone is a little wider than the scene: its radius squared by 1e-4.
        if (distance > radius)
            test.smallestCosine = std::sqrt(1 - 1.0001 * radius * radius / (distance * distance));
        const double even = 0.5 / kPiD / (1 - test.smallestCosine);
        const auto sample = [&] { return lamp.photon().direction; };
        EXPECT_GT(test.pValue(sample, [&](const Vec3f&) { return even; }), kSignificance);
        const double range = 1 - test.smallestCosine;
        const auto tilted = [&](const Vec3f& d) {
            const double c = static_cast<double>(dot(d, test.axis)) - test.smallestCosine;
            return even * (1 + 0.1 * (c / range - 0.5));
        };
        EXPECT_LT(test.pValue(sample, tilted), kSignificance);
    }
}

EmissionPoint emissionPoint(bool onSurface, float oneMinusCos) {
    EmissionPoint point;
    point.axis = normalize(Vec3f{0.5f, -0.3f, 0.8f});
    point.onSurface = onSurface;
    point.oneMinusCos = oneMinusCos;
    return point;
}

// No cone's edge runs along its bins.
DirectionTest slanting() {
    DirectionTest test;
    test.axis = normalize(Vec3f{0.4f, -0.7f, 0.3f});
    test.cosineBins = 32;
    test.subdivisions = 40;
    return test;
}

// Both say the density of a sample the same way.
template <typename Strategy>
double strategyPValue(const Strategy& strategy, double scale) {
    Random random(4);
    const auto sample = [&]() -> std::optional<Vec3f> {
        float stated;
        const Vec3f d = strategy.sample(random.next2D(), stated);
        if (!(stated > 0.0f)) return std::nullopt;
        return d;
    };
    return slanting().pValue(sample, [&](const Vec3f& d) {
        return scale * static_cast<double>(strategy.pdfSolidAngle(d));
    });
}

TEST(EmissionDirections, Unaimed) {
    for (const EmissionPoint& point :
         {emissionPoint(true, 2), emissionPoint(false, 2), emissionPoint(false, 0.6f)}) {
        EXPECT_GT(strategyPValue(point, 1), kSignificance);
        EXPECT_LT(strategyPValue(point, 0.97), kSignificance);
    }
}

TEST(EmissionDirections, Aimed) {
    const EmissionPoint surface = emissionPoint(true, 2), space = emissionPoint(false, 2);
    struct Case {
        EmissionPoint from;
        Caster caster;
        bool folded;
    };
    for (const Case& c : {Case{space, {{1, 1, 1}, 0.6}, false},
                          Case{surface, {Vec3d(surface.axis) * 2, 0.7}, false},
                          Case{surface, {{1.5, 0.3, 0}, 1.1}, true},
                          // Its centre lies below the plane.
                          Case{surface, {{-1.2, 0.3, 0.3}, 0.9}, true}}) {
        AimCone cone;
        ASSERT_TRUE(cone.aim(c.caster, c.from));
        ASSERT_FALSE(cone.all);
        EXPECT_EQ(cone.folded, c.folded);
        EXPECT_GT(strategyPValue(cone, 1), kSignificance);
        EXPECT_LT(strategyPValue(cone, 0.97), kSignificance);
    }
}

// Which of `n` equal shares v, in [0, 1], falls in.
std::size_t shareOf(double v, int n) {
    return static_cast<std::size_t>(std::clamp(static_cast<int>(v * n), 0, n - 1));
}

// Of a direction about an axis: 32 bins that hold equal parts of light that leaves by the cosine,
// or evenly over the sphere.
std::size_t directionBin(const Vec3f& d, const Vec3f& axis, bool byCosine) {
    const Frame frame(axis);
    const auto z = static_cast<double>(dot(d, axis));
    double turns = std::atan2(static_cast<double>(dot(d, frame.bitangent)),
                              static_cast<double>(dot(d, frame.tangent))) /
                   (2 * kPiD);
    turns -= std::floor(turns);
    return shareOf(byCosine ? 1 - z * z : (1 - z) / 2, 4) * 8 + shareOf(turns, 8);
}

struct AimedLamp {
    const char* name;
    std::function<void(SceneMaker&)> add;
    double flux;  // W
    // Which of `bins` equal parts of the lamp's light a photon belongs to.
    std::size_t bins;
    std::function<std::size_t(const Ray&)> bin;
};

std::vector<AimedLamp> aimedLamps() {
    const Vec3f down{0, -1, 0};
    return {
        {"quad",
         [](SceneMaker& m) {
             m.quad({-0.4, 0.9, -0.4}, {0.8, 0, 0}, {0, 0, 0.8}, m.diffuse({}, Rgb(1.0f)));
         },
         kPiD * 0.64, 128,
         [=](const Ray& ray) {
             const auto place = (ray.origin.x > 0.0f ? 1u : 0u) + (ray.origin.z > 0.0f ? 2u : 0u);
             return place * 32 + directionBin(ray.direction, down, true);
         }},
        {"sphere",
         [](SceneMaker& m) {
             m.sphere({0, 0, 0}, 0.2, m.diffuse({}, Rgb(1.0f)));
         },
         kPiD * 4 * kPiD * 0.04, 256,
         [](const Ray& ray) {
             const Vec3f n = normalize(ray.origin);
             const auto octant = (n.x > 0 ? 1u : 0u) + (n.y > 0 ? 2u : 0u) + (n.z > 0 ? 4u : 0u);
             return octant * 32 + directionBin(ray.direction, n, true);
         }},
        {"point",
         [](SceneMaker& m) {
             m.pointLight({0, 0, 0}, Rgb(1.0f));
         },
         4 * kPiD, 32, [=](const Ray& ray) { return directionBin(ray.direction, down, false); }},
    };
}

// Aimed photons leave every part of a lamp in every direction with the flux that the lamp sends
// there, however seldom they do: sums over bins against what is expected of them, in standard
// errors.
TEST(EmissionDirections, CarryTheLampsFluxEverywhere) {
    for (const AimedLamp& lamp : aimedLamps()) {
        SceneMaker maker;
        maker.box({-1, -1, -1}, {1, 1, 1}, maker.diffuse(Rgb(0.5f)), true);
        lamp.add(maker);
        maker.sphere({0.4, -0.6, 0.2}, 0.25, maker.material(glass()));
        maker.sphere({-0.6, 0.1, 0.4}, 0.2, maker.material(mirror()));
        const auto scene = maker.build();
        const LightSampler lights(*scene);
        AimedEmission aim(*scene, lights);
        PhotonTraceRequest pilot{PhotonKind::kCausticPilot, 20'000, 1, 1, &aim};
        pilot.keepRecords = true;
        aim.refine(tracePhotons(*scene, lights, pilot, std::atomic<bool>{false}, {}).records);
        Random random(5);
        constexpr int kPhotons = 1'000'000;
        std::vector<double> sum(lamp.bins), squares(lamp.bins);
        for (int n = 0; n < kPhotons; ++n) {
            AimedPhoton photon;
            const Vec2f uChoice = random.next2D(), uPoint = random.next2D();
            if (!aim.emit(uChoice, uPoint, random.next2D(), photon)) continue;
            const auto flux = static_cast<double>(photon.flux.r) / kPhotons;
            sum[lamp.bin(photon.ray)] += flux;
            squares[lamp.bin(photon.ray)] += flux * flux;
        }
        double right = 0, wrong = 0;
        for (std::size_t i = 0; i < lamp.bins; ++i) {
            const double expected = lamp.flux / static_cast<double>(lamp.bins);
            const double variance = squares[i] - sum[i] * sum[i] / kPhotons;
            ASSERT_GT(variance, 0.0) << lamp.name << ", bin " << i;
            // Twin: a fifth more along half of the turn, a fifth less along the other.
            const double skewed = expected * (i % 8 < 4 ? 1.2 : 0.8);
            right += (sum[i] - expected) * (sum[i] - expected) / variance;
            wrong += (sum[i] - skewed) * (sum[i] - skewed) / variance;
        }
        const auto freedom = static_cast<double>(lamp.bins);
        EXPECT_GT(chiSquaredPValue(right, freedom), kSignificance) << lamp.name << " " << right;
        EXPECT_LT(chiSquaredPValue(wrong, freedom), kSignificance) << lamp.name << " " << wrong;
    }
}

}  // namespace
}  // namespace pm::test
