// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Rough metal, rough glass and coats in whole renders: invisible in an even sky where they absorb
// nothing, and the same by photons as by paths in a room.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "integrator/light_sampling/light_sampler.h"
#include "integrator/transport/path/path_integrator.h"
#include "integrator/transport/photon/photon_integrator.h"
#include "tests/support/scene_maker.h"
#include "tests/support/statistics.h"

namespace pm::test {
namespace {

MaterialDescription metal(float roughness, Rgb colour = Rgb(1.0f)) {
    MaterialDescription m;
    m.kind = MaterialKind::kMirror;
    m.glossy = colour;
    m.roughness = roughness;
    return m;
}

MaterialDescription glass(float roughness) {
    MaterialDescription m;
    m.kind = MaterialKind::kDielectric;
    m.roughness = roughness;
    return m;
}

MaterialDescription coated(float roughness, Rgb below = Rgb(1.0f)) {
    MaterialDescription m;
    m.diffuse = below;
    m.glossy = Rgb(0.04f);
    m.roughness = roughness;
    return m;
}

MaterialDescription plaster(float roughness, Rgb colour = Rgb(1.0f)) {
    MaterialDescription m;
    m.diffuse = colour;
    m.diffuseRoughness = roughness;
    return m;
}

// A leaf.
MaterialDescription leaf(Rgb reflects, Rgb letsThrough) {
    MaterialDescription m;
    m.diffuse = reflects;
    m.diffuseTransmission = letsThrough;
    return m;
}

void expectInvisible(const MaterialDescription& material, IntegratorKind integrator,
                     double tolerance) {
    SceneMaker maker;
    maker.sphere({0, 0, 0}, 1, maker.material(material));
    maker.sky(Rgb(1.0f));
    maker.camera({0, 0, 5}, {0, 0, 0}, {0, 1, 0}, 20);
    RenderSettings settings = smallFrame(16, 16, integrator, 16, 4);
    settings.photons = 20'000;
    const MeasuredLayers found = measure(maker.build(), settings, {2, 2, 14, 14});
    EXPECT_TRUE(agrees(found.beauty, Rgb(1.0f), tolerance));
}

TEST(RoughSurfaces, AreInvisibleInAnEvenSky) {
    for (const IntegratorKind integrator : {IntegratorKind::kPath, IntegratorKind::kPhoton})
        for (const float roughness : {0.1f, 0.4f, 0.8f}) {
            SCOPED_TRACE(fmt::format("{} roughness {}",
                                     integrator == IntegratorKind::kPath ? "path" : "photon",
                                     roughness));
            expectInvisible(metal(roughness), integrator, 0.005);
            expectInvisible(glass(roughness), integrator, 0.01);
            expectInvisible(coated(roughness), integrator, 0.005);
            expectInvisible(plaster(roughness), integrator, 0.005);
        }
}

Rgb allOf(const SampleRadiance& sample) {
    return sample.emission + sample.direct + sample.caustic + sample.indirect;
}

// Of what a path from the eye finds in an even sky of radiance 1 where it meets a ball of glass,
// of roughness 1 and without absorption. sampleOf(scene, lights, ray, random): a path's beauty.
template <typename SampleOf>
Moments throughRoughBall(float ior, const SampleOf& sampleOf) {
    SceneMaker maker;
    MaterialDescription ball = glass(1.0f);
    ball.ior = ior;
    maker.sphere({0, 0, 0}, 1, maker.material(ball));
    maker.sky(Rgb(1.0f));
    const auto scene = maker.build();
    const LightSampler lights(*scene);
    constexpr std::uint32_t kParts = 64;
    constexpr std::uint32_t kOfPart = 800;
    std::vector<double> values(kParts * kOfPart);
    tbb::parallel_for(0u, kParts, [&](std::uint32_t part) {
        Random places(part + 1);
        for (std::uint32_t i = 0; i < kOfPart; ++i) {
            const Vec2f at = places.next2D();
            const Vec3f target{1.2f * at.x - 0.6f, 1.2f * at.y - 0.6f, 0.0f};
            const Ray ray{.origin = {0, 0, 4}, .direction = normalize(target - Vec3f{0, 0, 4})};
            const Sampler random(1, 2, part, i);
            values[part * kOfPart + i] =
                static_cast<double>(sampleOf(*scene, lights, ray, random).g);
        }
    });
    return momentsOf(kParts * kOfPart, [&](std::uint32_t i) { return values[i]; });
}

// No facet's choice between its two ways is in a weight, and roulette doesn't take what is bent
// into a narrower cone for less. Photons' camera paths divide, by what weights have raised, too.
TEST(RoughSurfaces, AClosedBallOfRoughGlassVariesLittle) {
    const auto byPath = [](const Scene& scene, const LightSampler& lights, const Ray& ray,
                           const Sampler& random) {
        return allOf(PathIntegrator(scene, lights).sample(ray, random));
    };
    const auto byPhoton = [](const Scene& scene, const LightSampler& lights, const Ray& ray,
                             const Sampler& random) {
        NearestPhotons scratch;
        const PhotonIntegrator integrator(scene, lights, PhotonMaps{});
        return allOf(integrator.sample({.screen = {}, .ray = ray}, random, scratch));
    };
    struct Ball {
        float ior;
        double mostVariance, mostByPhoton;
    };
    for (const Ball& ball : {Ball{1.5f, 2.0, 0.2}, Ball{2.4f, 20.0, 0.5}, Ball{0.5f, 0.6, 0.2}}) {
        const auto check = [&](const char* name, const Moments& found, double mostVariance) {
            fmt::print("    index {}, {}: mean {:.5f} +- {:.5f}, variance {:.3f}\n", ball.ior, name,
                       found.mean, found.standardError, found.variance);
            EXPECT_LT(found.variance, mostVariance) << name << ", index " << ball.ior;
            EXPECT_NEAR(found.mean, 1.0, 0.003 + 2 * found.standardError)
                << name << ", index " << ball.ior;
        };
        check("path", throughRoughBall(ball.ior, byPath), ball.mostVariance);
        check("photon", throughRoughBall(ball.ior, byPhoton), ball.mostByPhoton);
    }
}

// A sheet under a parallel light from behind shows what it lets through; with light from all around
// it is invisible where it absorbs nothing.
TEST(RoughSurfaces, LeavesLetLightThrough) {
    for (const IntegratorKind integrator : {IntegratorKind::kPath, IntegratorKind::kPhoton}) {
        SceneMaker maker;
        maker.quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0},
                   maker.material(leaf(Rgb(0.3f), {0.1f, 0.4f, 0.05f})));
        maker.sun({0, 0, 1}, Rgb(2.0f), 0);
        maker.camera({0, 0, 3}, {0, 0, 0}, {0, 1, 0}, 20);
        RenderSettings settings = smallFrame(8, 8, integrator, 8, 3);
        settings.photons = 20'000;
        const float scale = 2.0f / 3.14159265f;
        EXPECT_TRUE(agrees(measure(maker.build(), settings).beauty,
                           {0.1f * scale, 0.4f * scale, 0.05f * scale}, 1e-3));
        SceneMaker even;
        even.quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, even.material(leaf(Rgb(0.4f), Rgb(0.6f))));
        even.sky(Rgb(1.0f));
        even.camera({0, 0, 3}, {0, 0, 0}, {0, 1, 0}, 20);
        EXPECT_TRUE(agrees(measure(even.build(), settings).beauty, Rgb(1.0f), 0.005));
    }
}

// A room with all of them, lit from its ceiling.
std::shared_ptr<const Scene> room() {
    SceneMaker maker;
    const auto white = maker.material(plaster(0.8f, Rgb(0.7f)));
    const auto floor = maker.material(coated(0.3f, Rgb(0.5f, 0.4f, 0.3f)));
    maker.quad({-1, -1, 1}, {2, 0, 0}, {0, 0, -2}, floor);
    maker.quad({-1, 1, -1}, {2, 0, 0}, {0, 0, 2}, white);
    maker.quad({-1, -1, -1}, {2, 0, 0}, {0, 2, 0}, white);
    maker.quad({-1, -1, 1}, {0, 0, -2}, {0, 2, 0}, maker.diffuse({0.6f, 0.1f, 0.1f}));
    maker.quad({1, -1, -1}, {0, 0, 2}, {0, 2, 0}, maker.diffuse({0.1f, 0.5f, 0.1f}));
    maker.quad({-0.5, 0.95, -0.5}, {1, 0, 0}, {0, 0, 1}, maker.diffuse({}, Rgb(8.0f)));
    maker.sphere({0.5, -0.6, -0.4}, 0.4, maker.material(metal(0.3f, {0.9f, 0.8f, 0.5f})));
    maker.sphere({-0.5, -0.6, -0.3}, 0.4, maker.material(metal(0.7f, {0.9f, 0.9f, 0.9f})));
    maker.sphere({0.1, -0.65, 0.4}, 0.35, maker.material(glass(0.35f)));
    maker.quad({-0.9, 0.2, 0.2}, {0.7, 0, 0}, {0, 0.2, -0.6},
               maker.material(leaf({0.2f, 0.4f, 0.1f}, {0.1f, 0.4f, 0.1f})));
    maker.camera({0, 0, 4.2}, {0, 0, 0}, {0, 1, 0}, 36);
    return maker.build();
}

// Light that comes flat over a floor from a low wall, which a level sun lights: half of it is
// reflected by the floor's boundary, or by what covers it. Points that are kept know that.
void expectKeptPointsKnow(const MaterialDescription& floor, std::uint32_t passes) {
    SceneMaker maker;
    maker.quad({-2, 0, 2}, {4, 0, 0}, {0, 0, -4}, maker.material(floor));
    maker.quad({-2, 0, -2}, {0, 0, 4}, {0, 0.6, 0}, maker.diffuse(Rgb(0.8f)));
    maker.sun({-1, 0, 0}, Rgb(3.0f), 0);
    maker.camera({0, 4, 0.01}, {0, 0, 0}, {0, 0, -1}, 30);
    RenderSettings settings = smallFrame(8, 8, IntegratorKind::kPath, passes, 4);
    const MeasuredLayers path = measure(maker.build(), settings);
    settings.integrator = IntegratorKind::kPhoton;
    settings.photons = 100'000;
    const MeasuredLayers photon = measure(maker.build(), settings);
    EXPECT_TRUE(agree(photon.indirect, path.indirect, 0.03));
}

TEST(RoughSurfaces, KeptPointsKnowWhatPlasticLetsIn) {
    expectKeptPointsKnow(coated(0.1f, Rgb(0.8f)), 64);
}

TEST(RoughSurfaces, KeptPointsKnowWhatCoatsAndFibresLetIn) {
    MaterialDescription coat = plaster(0.0f, Rgb(0.8f));
    coat.coat = 1.0f;
    coat.coatRoughness = 0.5f;
    MaterialDescription fibres = plaster(0.0f, Rgb(0.8f));
    fibres.sheen = Rgb(0.8f);
    fibres.sheenRoughness = 0.5f;
    MaterialDescription both = coated(0.4f, Rgb(0.8f));
    both.coat = 0.6f;
    both.coatRoughness = 0.5f;
    for (const MaterialDescription& floor : {coat, fibres, both}) {
        SCOPED_TRACE(fmt::format("coat {} sheen {}", floor.coat, floor.sheen.g));
        expectKeptPointsKnow(floor, 24);
    }
}

// Regions of the frame: bias allowed 2 % of the frame's mean, as estimates' discs reach round
// corners and blur caustics.
TEST(RoughSurfaces, PhotonsAndPathsAgree) {
    const auto scene = room();
    std::vector<Rect> regions;
    for (int y = 0; y < 32; y += 8)
        for (int x = 0; x < 32; x += 8) regions.push_back({x, y, x + 8, y + 8});
    regions.push_back({0, 0, 32, 32});
    const auto render = [&](IntegratorKind integrator, std::uint32_t level) {
        RenderSettings settings = smallFrame(32, 32, integrator, 16, level);
        settings.photons = 60'000;
        return measureRegions(scene, settings, {0, 0, 32, 32}, regions);
    };
    const auto photon = render(IntegratorKind::kPhoton, 4), path = render(IntegratorKind::kPath, 6);
    const double frame = path.back().beauty.mean[1];
    double worst = 0;
    for (std::size_t i = 0; i < regions.size(); ++i)
        for (std::size_t c = 0; c < 3; ++c) {
            const Measured &a = photon[i].beauty, &b = path[i].beauty;
            const double error = std::hypot(a.standardError[c], b.standardError[c]);
            const double off = std::abs(a.mean[c] - b.mean[c]) - 0.02 * frame;
            worst = std::max(worst, off / error);
            EXPECT_LT(off, 5 * error)
                << "region " << i << " channel " << c << ": photon " << a.mean[c] << " +- "
                << a.standardError[c] << ", path " << b.mean[c] << " +- " << b.standardError[c];
        }
    EXPECT_TRUE(agree(photon.back().beauty, path.back().beauty, 0.01));
    fmt::print("    largest |z| beyond the bias {:.2f}; frame: photon {:.5f} path {:.5f}\n", worst,
               photon.back().beauty.mean[1], frame);
}

}  // namespace
}  // namespace pm::test
