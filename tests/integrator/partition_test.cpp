// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Every light path in exactly one class, every class with exactly one estimator: the sum of the
// classes, and each class, against path tracing; and the same light by another estimator.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/integrator/replicates.h"
#include "tests/integrator/rooms.h"

namespace pm::test {
namespace {

constexpr std::int32_t kSize = 64, kRegion = 8;
constexpr int kRenders = 12;

RenderSettings settingsOf(IntegratorKind integrator, std::uint64_t seed) {
    const bool photon = integrator == IntegratorKind::kPhoton;
    RenderSettings settings = smallFrame(kSize, kSize, integrator, 4, photon ? 3 : 4);
    settings.photons = 40'000;
    // Of one seed both would have their samples at the same places in the pixels: the errors of
    // both are to be independent.
    settings.seed = photon ? seed : seed + 4000;
    return settings;
}

class Partition : public ::testing::TestWithParam<Room> {};

INSTANTIATE_TEST_SUITE_P(Rooms, Partition, ::testing::ValuesIn(roomsOfEveryLobe()), roomName);

// By 8 x 8 regions, and of the whole frame. Biases allowed to single layers: caustics are blurred
// from one region into the next and fade towards edges, indirect light is blurred, too. Of the
// whole picture the estimated bias is taken off, and nothing is allowed for what is left.
TEST_P(Partition, AgreesWithPath) {
    const auto scene = GetParam().maker.build();
    const std::string& name = GetParam().name;
    const std::vector<Rect> regions = squares(kSize, kSize, kRegion);
    const auto rendered = [&](IntegratorKind integrator) {
        return replicate(kRenders, [&](std::uint64_t seed) {
            return render(scene, settingsOf(integrator, seed), regions);
        });
    };
    const auto photon = rendered(IntegratorKind::kPhoton), path = rendered(IntegratorKind::kPath);
    const auto compare = [&](Layer layer, double regionBias, double frameBias) {
        expectAgreement(photon, path, layer, regionBias, 4, name);
        expectAgreement(wholeFrames(photon), wholeFrames(path), layer, frameBias, 4, name);
    };
    // A single path that sees the lamp in glass brings 3e-4 to a region of all path-traced renders;
    // where none does, their spread is 0.
    compare(kEmission, 0.005, 0);
    compare(kDirect, 0, 0);
    compare(kCaustic, 0.15, 0.03);
    compare(kIndirect, 0.03, 0.012);
    compare(kCorrected, 0, 0.003);
    // The classes sum to the picture.
    for (const auto& renders : {photon, path})
        for (const LayerMeans& m : renders.front())
            for (std::size_t c = 0; c < 3; ++c)
                EXPECT_NEAR(m[kEmission][c] + m[kDirect][c] + m[kCaustic][c] + m[kIndirect][c],
                            m[kBeauty][c], 1e-6 * m[kBeauty][c]);
}

// Light descended from caustics, found by gather rays that meet those, and by an estimate of its
// own, where it is a tenth of all light. PhotonClasses.AddUp looks closer.
TEST(PartitionMoves, LightDescendedFromCaustics) {
    for (const Room& room : roomsOfEveryLobe()) {
        if (room.name != "mirror behind glass" && room.name != "partly transparent") continue;
        const auto scene = room.maker.build();
        const std::vector<Rect> regions = squares(kSize, kSize, 16);
        const auto rendered = [&](float descent) {
            return replicate(8, [&](std::uint64_t seed) {
                RenderSettings settings = settingsOf(IntegratorKind::kPhoton, seed);
                settings.passes = 2;
                Plan plan = makePlan(*scene, settings);
                EXPECT_GT(plan.descent, 0);
                plan.descent = descent;
                return PlannedRender(scene, settings, plan).render(regions, 2);
            });
        };
        const auto gathered = rendered(0), estimated = rendered(0.5f);
        expectAgreement(estimated, gathered, kCorrected, 0.01, 4, room.name);
        expectAgreement(wholeFrames(estimated), wholeFrames(gathered), kCorrected, 0.002, 4,
                        room.name);
        const Replicated whole = spread(wholeFrames(gathered), 0, kCorrected, 1);
        EXPECT_LT(whole.standardError, 0.01 * whole.mean);
    }
}

// What a plan leaves out, since the scene has no need of it, would have brought nothing.
TEST(PartitionMoves, PlanEverything) {
    std::vector<Room> rooms = {roomsOfEveryLobe().front()};
    const auto seen = [](SceneMaker maker) {
        maker.camera({0, 2, 3}, {0, 0, 0}, {0, 1, 0}, 40);
        return maker;
    };
    SceneMaker flat;
    flat.quad({-1, 0, 1}, {2, 0, 0}, {0, 0, -2}, flat.diffuse(Rgb(0.5f)));
    flat.pointLight({0.3, 1, 0}, Rgb(1.0f));
    rooms.push_back({"flat floor", seen(flat)});
    SceneMaker mirrors;
    mirrors.quad({-1, 0, 1}, {2, 0, 0}, {0, 0, -2}, mirrors.material(mirror()));
    mirrors.sphere({0, 0.5, 0}, 0.3, mirrors.diffuse({}, Rgb(1.0f)));
    rooms.push_back({"nothing diffuse", seen(mirrors)});
    SceneMaker dark;
    dark.quad({-1, 0, 1}, {2, 0, 0}, {0, 0, -2}, dark.diffuse(Rgb(0.5f)));
    dark.sphere({0, 0.5, 0}, 0.3, dark.material(glass()));
    rooms.push_back({"nothing shines", seen(dark)});
    for (const Room& room : rooms) {
        const auto scene = room.maker.build();
        const std::vector<Rect> regions = squares(32, 32, 8);
        const auto rendered = [&](PlanKind plan) {
            return replicate(8, [&](std::uint64_t seed) {
                RenderSettings settings = smallFrame(32, 32, IntegratorKind::kPhoton, 2, 3);
                settings.photons = 20'000;
                settings.seed = seed;
                settings.plan = plan;
                EXPECT_TRUE(plan == PlanKind::kAuto || makePlan(*scene, settings).causticMap);
                return render(scene, settings, regions);
            });
        };
        const auto automatic = rendered(PlanKind::kAuto);
        const auto everything = rendered(PlanKind::kEverything);
        EXPECT_EQ(spread(automatic, 5, kBeauty, 1).mean == 0, room.name == "nothing shines");
        expectAgreement(everything, automatic, kCorrected, 0, 4, room.name);
        expectAgreement(wholeFrames(everything), wholeFrames(automatic), kCorrected, 0, 4,
                        room.name);
    }
}

// Where there are no caustics a map of them brings nothing and changes nothing: the same bits. (The
// pilot of lamp samples would take more of them, since all else takes longer.)
TEST(PartitionMoves, MapsWithoutPhotonsChangeNoBit) {
    SceneMaker maker = openRoom();
    ceilingLamp(maker, 0.25, Rgb(15.0f));
    maker.box({-0.6, -1, -0.6}, {-0.1, 0.2, -0.1}, maker.diffuse(Rgb(0.7f)), false);
    maker.camera({0, 0, 3.9}, {0, 0, 0}, {0, 1, 0}, 40);
    const auto scene = maker.build();
    const std::vector<Rect> pixels = squares(32, 32, 1);
    const auto rendered = [&](PlanKind kind) {
        RenderSettings settings = smallFrame(32, 32, IntegratorKind::kPhoton, 2, 2);
        settings.plan = kind;
        Plan plan = makePlan(*scene, settings);
        EXPECT_EQ(plan.causticMap, kind == PlanKind::kEverything);
        plan.lampSamples = 2;
        return PlannedRender(scene, settings, plan).render(pixels, 2);
    };
    const RegionMeans automatic = rendered(PlanKind::kAuto);
    EXPECT_EQ(rendered(PlanKind::kEverything), automatic);
    double indirect = 0;
    for (const LayerMeans& pixel : automatic) indirect += pixel[kIndirect][0];
    EXPECT_GT(indirect, 0);
}

}  // namespace
}  // namespace pm::test
