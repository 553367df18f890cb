// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Light that is scattered thousands of times: rooms that reflect nearly all of it, tubes of
// mirrors. And what nothing can end is told of.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <vector>

#include "integrator/light_sampling/light_sampler.h"
#include "integrator/photons/trace/long_chains.h"
#include "integrator/photons/trace/photon_tracer.h"
#include "tests/support/rooms.h"
#include "tests/support/scene_maker.h"
#include "tests/support/statistics.h"

namespace pm::test {
namespace {

std::uint32_t shining(SceneMaker& maker, float reflectance) {
    return maker.diffuse(Rgb(reflectance), Rgb(1.0f - reflectance));
}

// Whatever walls reflect, radiance is 1 everywhere, as each emits what it lacks.
SceneMaker furnace(float reflectance) {
    SceneMaker maker;
    maker.box({-1, -1, -1}, {1, 1, 1}, shining(maker, reflectance), true);
    maker.camera({0, 0, 0.9}, {0.1, 0.2, 0}, {0, 1, 0}, 60);
    return maker;
}

RenderSettings frame(IntegratorKind integrator, std::uint32_t passes) {
    const bool isPhoton = integrator == IntegratorKind::kPhoton;
    RenderSettings settings =
        smallFrame(isPhoton ? 16 : 4, isPhoton ? 16 : 4, integrator, passes, 2);
    settings.photons = 2000;
    return settings;
}

TEST(BrightRooms, RadianceIsOne) {
    for (const float reflectance : {0.9f, 0.99f, 0.999f, 0.9999f}) {
        const MeasuredLayers m =
            measure(furnace(reflectance).build(), frame(IntegratorKind::kPhoton, 8));
        EXPECT_TRUE(agrees(m.beauty, Rgb(1.0f), 0.002)) << reflectance;
        EXPECT_LT(m.beauty.standardError[0], 0.02) << reflectance;
        EXPECT_EQ(m.counters.photonsLost, 0u);
        std::printf("    %.4f: %.4f +- %.4f, %llu landings of %llu photons\n",
                    static_cast<double>(reflectance), m.beauty.mean[0], m.beauty.standardError[0],
                    static_cast<unsigned long long>(m.counters.photonsStoredGlobal),
                    static_cast<unsigned long long>(m.counters.photonsEmitted));
    }
}

TEST(BrightRooms, RadianceIsOneByPaths) {
    for (const float reflectance : {0.99f, 0.999f, 0.9999f}) {
        const MeasuredLayers m =
            measure(furnace(reflectance).build(),
                    frame(IntegratorKind::kPath, reflectance > 0.9995f ? 8 : 64));
        EXPECT_TRUE(agrees(m.beauty, Rgb(1.0f), 0)) << reflectance;
        EXPECT_EQ(m.counters.pathsCut, 0u);
    }
}

// Walls of unlike reflectance, and in the ceiling a black slit that shines: a hole to light of 1.
TEST(BrightRooms, UnlikeWalls) {
    SceneMaker maker;
    const auto bright = shining(maker, 0.9999f), grey = shining(maker, 0.98f);
    maker.quad({-1, -1, 1}, {2, 0, 0}, {0, 0, -2}, bright);  // floor
    maker.quad({-0.9, 1, -1}, {1.9, 0, 0}, {0, 0, 2}, bright);
    maker.quad({-1, 1, -1}, {0.1, 0, 0}, {0, 0, 2}, shining(maker, 0.0f));
    maker.quad({-1, -1, -1}, {2, 0, 0}, {0, 2, 0}, bright);
    maker.quad({1, -1, 1}, {-2, 0, 0}, {0, 2, 0}, bright);
    maker.quad({-1, -1, 1}, {0, 0, -2}, {0, 2, 0}, grey);
    maker.quad({1, -1, -1}, {0, 0, 2}, {0, 2, 0}, bright);
    maker.camera({0, 0, 0.9}, {-0.3, 0.3, 0}, {0, 1, 0}, 70);
    const RenderSettings photons = frame(IntegratorKind::kPhoton, 16);
    ASSERT_GT(makePlan(*maker.build(), photons).oneInChains, 0u);
    EXPECT_TRUE(agrees(measure(maker.build(), photons).beauty, Rgb(1.0f), 0.002));
    EXPECT_TRUE(
        agrees(measure(maker.build(), frame(IntegratorKind::kPath, 64)).beauty, Rgb(1.0f), 0));
}

// A bright room and a dark one, far from each other, in one picture's photons.
TEST(BrightRooms, ARoomBesideIsNotStarved) {
    SceneMaker alone;
    alone.box({4, -1, -1}, {6, 1, 1}, alone.diffuse(Rgb(0.5f), Rgb(0.5f)), true);
    alone.camera({5, 0, 0.9}, {5.1, 0.2, 0}, {0, 1, 0}, 60);
    SceneMaker both = alone;
    both.box({-1, -1, -1}, {1, 1, 1}, both.diffuse(Rgb(0.9999f), Rgb(0.5f)), true);
    RenderSettings settings = frame(IntegratorKind::kPhoton, 16);
    const MeasuredLayers wanted = measure(alone.build(), settings);
    settings.photons *= 2;  // half of them for each
    ASSERT_GT(makePlan(*both.build(), settings).oneInChains, 0u);
    const MeasuredLayers found = measure(both.build(), settings);
    EXPECT_TRUE(agrees(found.beauty, Rgb(1.0f), 0.002));
    // By 16 seeds 1.7 to 4.4 times; starved it is ten and more.
    EXPECT_LT(found.beauty.standardError[0], 6 * wanted.beauty.standardError[0]);
}

// All light comes by way of glass, so chains are those of light descended from caustics.
TEST(BrightRooms, ALampInABulb) {
    SceneMaker maker;
    maker.box({-1, -1, -1}, {1, 1, 1}, maker.diffuse(Rgb(0.98f)), true);
    maker.sphere({0, 0.5, 0}, 0.3, maker.material(glass()));
    maker.sphere({0, 0.5, 0}, 0.15, maker.diffuse({}, Rgb(1.0f)));
    maker.camera({0, -0.2, 0.9}, {0, -0.4, 0}, {0, 1, 0}, 60);
    RenderSettings settings = frame(IntegratorKind::kPhoton, 8);
    settings.photons = 8000;
    ASSERT_GT(makePlan(*maker.build(), settings).oneInChains, 0u);
    const MeasuredLayers photons = measure(maker.build(), settings);
    RenderSettings paths = smallFrame(16, 16, IntegratorKind::kPath, 16, 3);
    EXPECT_TRUE(agree(photons.indirect, measure(maker.build(), paths).indirect, 0.01));
}

// ---- Chains -------------------------------------------------------------------------------

PhotonTraceResult trace(const Scene& scene, std::uint64_t count, std::uint32_t oneIn,
                        std::uint32_t pass) {
    PhotonTraceRequest request{PhotonKind::kGlobal, count, 1, pass};
    request.oneInChains = oneIn;
    return tracePhotons(scene, LightSampler(scene), request, std::atomic<bool>{false}, {});
}

double landedFlux(const PhotonTraceResult& traced) {
    double sum = 0;
    for (const Photon& photon : traced.photons) sum += channelSum(photon.flux);
    return sum;
}

// Chains bring as much as photons one by one, where light is absorbed and where it escapes.
TEST(LongChains, KeepTheFluxThatLands) {
    SceneMaker holed;
    holed.box({-1, -1, -1}, {1, 1, 1}, holed.diffuse(Rgb(0.9999f)), true);
    holed.quad({-0.9, -0.99, 0.9}, {1.8, 0, 0}, {0, 0, -0.3}, holed.diffuse({}));
    holed.quad({-0.2, 0.99, -0.2}, {0.4, 0, 0}, {0, 0, 0.4}, holed.diffuse({}, Rgb(1, 2, 4)));
    SceneMaker closed;
    closed.box({-1, -1, -1}, {1, 1, 1}, closed.diffuse(Rgb(0.99f, 0.98f, 0.9f)), true);
    closed.pointLight({0, 0, 0}, Rgb(1, 2, 4));
    for (const SceneMaker& maker : {holed, closed}) {
        const auto scene = maker.build();
        for (const std::uint32_t oneIn : {1u, 4u}) {
            Measured chains, photons;
            constexpr int kPasses = 64;
            const auto measured = [&](std::uint32_t in, Measured& m) {
                double sum = 0, squares = 0;
                for (int pass = 0; pass < kPasses; ++pass) {
                    const PhotonTraceResult traced =
                        trace(*scene, 1024, in, static_cast<std::uint32_t>(pass));
                    const PhotonBalance& b = traced.balance;
                    EXPECT_NEAR((b.fluxAbsorbed + b.fluxEscaped) / b.fluxEmitted, 1, 1e-6);
                    EXPECT_EQ(b.lost, 0u);
                    const double landed = landedFlux(traced) / b.fluxEmitted;
                    sum += landed;
                    squares += landed * landed;
                }
                const double mean = sum / kPasses;
                m.mean.fill(mean);
                m.standardError.fill(std::sqrt((squares / kPasses - mean * mean) / kPasses));
            };
            measured(oneIn, chains);
            measured(0, photons);
            EXPECT_TRUE(agree(chains, photons, 0)) << oneIn;
        }
    }
}

// However bright the room, so many landings are stored and no more, each for about as much.
TEST(LongChains, StoreAFewLandings) {
    for (const float reflectance : {0.999f, 0.9999f}) {
        const auto scene = furnace(reflectance).build();
        RenderSettings settings = frame(IntegratorKind::kPhoton, 1);
        const Plan plan = makePlan(*scene, settings);
        const PhotonTraceResult traced = trace(*scene, plan.globalPhotons, plan.oneInChains, 0);
        const auto stored = static_cast<double>(traced.balance.stored);
        EXPECT_NEAR(landedFlux(traced) / traced.balance.fluxEmitted * (1 - reflectance), 1, 0.1);
        EXPECT_LT(stored / 2000, 80) << reflectance;
        EXPECT_GT(stored / 2000, 8) << reflectance;
        EXPECT_LT(std::abs(std::log(stored / static_cast<double>(plan.globalLandings()))),
                  std::log(1.5))
            << reflectance;
    }
}

TEST(LongChains, OrdinaryRoomsHaveNone) {
    for (const float reflectance : {0.2f, 0.5f, 0.75f, 0.85f, 0.9f}) {
        const Plan plan =
            makePlan(*furnace(reflectance).build(), frame(IntegratorKind::kPhoton, 1));
        EXPECT_EQ(plan.oneInChains, 0u) << reflectance;
        EXPECT_EQ(plan.globalPhotons, 2000u);
        EXPECT_NEAR(plan.landingsOfPhoton * (1 - static_cast<double>(reflectance)), 1, 0.1);
    }
    EXPECT_GT(makePlan(*furnace(0.97f).build(), frame(IntegratorKind::kPhoton, 1)).oneInChains, 0u);
}

// Of a power of two of photons the same number goes on, whatever the pass, but not the same ones.
TEST(LongChains, AreSharedOutEvenly) {
    std::vector<std::uint32_t> chosen;
    for (const std::uint64_t key : {1u, 2u, 3u}) {
        const LongChains chains(4, 2048, 1.0f, key);
        std::uint32_t count = 0, first = 0;
        for (std::uint32_t index = 2048; index-- > 0;) {
            LongChains::Chain chain{.index = index};
            for (int landing = 0; landing < 16; ++landing) LongChains::land(chain, 1.0f);
            if (chains.goOn(chain) == 0.0f) continue;
            EXPECT_EQ(chain.reference, 16.0f);
            EXPECT_EQ(chains.storing(chain, 8.0f), 0.5f);
            ++count;
            first = index;
        }
        EXPECT_EQ(count, 128u);
        chosen.push_back(first);
    }
    EXPECT_FALSE(chosen[0] == chosen[1] && chosen[1] == chosen[2]);
    EXPECT_EQ(LongChains::wholeNumber(2000), 2048u);
    EXPECT_EQ(LongChains::wholeNumber(5), 5u);
}

// ---- Shading normals ----------------------------------------------------------------------

SceneMaker roomOfSmoothBalls(float reflectance) {
    SceneMaker maker = furnace(reflectance);
    maker.meshSphere({0.3, 0, -0.3}, 0.3, maker.material(mirror(1.0f)), false, 16);
    maker.meshSphere({-0.4, -0.3, -0.2}, 0.25, maker.material(glass()), false, 16);
    return maker;
}

// Corrections for shading normals, one after the other, leave no photon with the flux of many.
TEST(SmoothNormals, KeepTheFluxOfPhotonsEven) {
    const auto scene = roomOfSmoothBalls(0.99f).build();
    const PhotonTraceResult traced = trace(*scene, 4096, 0, 0);
    double largest = 0;
    for (const Photon& photon : traced.photons)
        largest = std::max(largest, channelSum(photon.flux));
    const double emitted = traced.balance.fluxEmitted / 4096;
    EXPECT_GT(largest / emitted, 1.5);
    EXPECT_LT(largest / emitted, 2.5);
    const PhotonBalance& b = traced.balance;
    EXPECT_NEAR((b.fluxAbsorbed + b.fluxEscaped) / b.fluxEmitted, 1, 1e-6);
}

// Radiance is 1 in such a room: no render lacks what a few photons have.
TEST(SmoothNormals, LoseNothingInBrightRooms) {
    const auto scene = roomOfSmoothBalls(0.99f).build();
    const Moments found = momentsOf(16, [&](std::uint32_t seed) {
        RenderSettings settings = frame(IntegratorKind::kPhoton, 2);
        settings.seed = seed + 1;
        return measure(scene, settings).beauty.mean[0];
    });
    std::printf("    mean %.4f +- %.4f\n", found.mean, found.standardError);
    EXPECT_LT(found.standardError, 0.04);
    EXPECT_NEAR(found.mean, 1.0, 0.005 + 2.5 * found.standardError);
}

// ---- Mirrors ------------------------------------------------------------------------------

// A square tube with a lamp at its end, looked into so steeply that light is reflected `bounces`
// times: radiance is what the mirrors leave of the lamp's.
SceneMaker tube(float reflectance, double bounces) {
    SceneMaker maker;
    const auto walls = maker.material(mirror(reflectance));
    maker.quad({-0.5, -0.5, 0}, {1, 0, 0}, {0, 0, -10}, walls);
    maker.quad({-0.5, 0.5, -10}, {1, 0, 0}, {0, 0, 10}, walls);
    maker.quad({-0.5, -0.5, 0}, {0, 0, -10}, {0, 1, 0}, walls);
    maker.quad({0.5, -0.5, -10}, {0, 0, 10}, {0, 1, 0}, walls);
    maker.quad({-0.5, -0.5, -10}, {1, 0, 0}, {0, 1, 0}, maker.diffuse({}, Rgb(1.0f)));
    maker.camera({0, 0, -0.01}, {bounces, 0, -10}, {0, 1, 0}, 1e-5);
    return maker;
}

class MirrorTube : public ::testing::TestWithParam<IntegratorKind> {};
INSTANTIATE_TEST_SUITE_P(Both, MirrorTube,
                         ::testing::Values(IntegratorKind::kPhoton, IntegratorKind::kPath),
                         [](const auto& info) {
                             return info.param == IntegratorKind::kPhoton ? "photon" : "path";
                         });

TEST_P(MirrorTube, KeepsWhatMirrorsLeave) {
    for (const auto& [reflectance, bounces] :
         {std::pair{0.999f, 1000.0}, {1.0f, 1000.0}, {1.0f, 3000.0}, {0.9999f, 3000.0}}) {
        const MeasuredLayers m =
            measure(tube(reflectance, bounces).build(), smallFrame(8, 8, GetParam(), 16, 2));
        const double expected = std::pow(static_cast<double>(reflectance), bounces);
        EXPECT_TRUE(agrees(m.emission, Rgb(static_cast<float>(expected)), 0))
            << reflectance << ", " << bounces;
        EXPECT_GT(m.emission.mean[0], 0.0);
        EXPECT_EQ(m.counters.pathsCut, 0u);
    }
}

// Between perfect mirrors nothing can end: what is cut is told, and counts as error.
TEST_P(MirrorTube, ToldWhereNothingEnds) {
    SceneMaker maker;
    maker.box({-1, -1, -1}, {1, 1, 1}, maker.material(mirror(1.0f)), true);
    maker.pointLight({0, 0.3, 0}, Rgb(1.0f));
    maker.quad({-9, -9, -5}, {18, 0, 0}, {0, 18, 0}, maker.diffuse(Rgb(0.5f)));
    maker.camera({0, 0, 0.9}, {0.1, 0.2, 0}, {0, 1, 0}, 60);
    RenderSettings settings = smallFrame(8, 8, GetParam(), 1, 2);
    settings.photons = 64;
    FrameRenderer renderer(maker.build(), settings);
    const std::atomic<bool> cancelled{false};
    renderer.beginPass(0, cancelled, {});
    std::vector<float> pixels(64 * static_cast<std::size_t>(renderer.layout().count)), weights(64);
    renderer.renderRegion(settings.window, pixels, weights, cancelled);
    const RenderCounters counters = renderer.counters();
    EXPECT_GT(counters.pathsCut, 0u);
    // What roulette left counts for all.
    EXPECT_NEAR(counters.throughputCut / static_cast<double>(counters.cameraSamples), 1, 0.8);
    EXPECT_GT(counters.shareCut(), 0.2);
    std::vector<NoticeCode> codes;
    for (const Notice& notice : renderer.takeNotices()) codes.push_back(notice.code);
    EXPECT_EQ(std::ranges::count(codes, NoticeCode::kNotCovered), 1);
    if (GetParam() == IntegratorKind::kPath) return;
    EXPECT_GT(counters.fluxLost, 0.2 * counters.fluxEmitted);
    EXPECT_EQ(std::ranges::count(codes, NoticeCode::kLostPhotons), 2);
}

}  // namespace
}  // namespace pm::test
