// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Every light path in exactly one class, every class with exactly one estimator: the sum of the
// classes, and each class, against path tracing; and the same light by another estimator.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <string>
#include <vector>

#include "tests/support/looks.h"
#include "tests/support/replicates.h"
#include "tests/support/rooms.h"

namespace pm::test {
namespace {

// By 8 x 8 regions, of each frame, and of all frames together, which tell a hundredth of the
// indirect light. No bias is allowed for but what the renderer's own estimate leaves. Among
// thousands of regions' numbers a few are beyond 4 standard errors by chance, the more as path
// tracing may miss a region's rare light and with it its spread: those are looked at again.
// PM_TEST_LONG=1: frames of 48 pixels and not of 32.
TEST(Partition, AgreesWithPath) {
    LookSize size;
    if (std::getenv("PM_TEST_LONG") == nullptr) size.frame = 32;
    Look frames;
    for (const Room& room : roomsOfEveryLobe()) {
        const auto scene = room.maker.build();
        const Look first = look(scene, size);
        const Look frame = first.ofWholeFrame();
        expectFrameAgrees(frame, room.name + ", frame");
        lookAgain(scene, size, first, room.name);
        addFrame(frames, frame);
    }
    expectFrameAgrees(frames, "all frames");
}

// Light descended from caustics, found by gather rays that meet those, and by an estimate of its
// own, where it is a tenth of all light. PhotonClasses.AddUp looks closer.
TEST(PartitionMoves, LightDescendedFromCaustics) {
    for (const Room& room : roomsOfEveryLobe()) {
        if (room.name != "mirror behind glass" && room.name != "partly transparent") continue;
        const auto scene = room.maker.build();
        const std::vector<Rect> regions = squares(LookSize{}.frame, LookSize{}.frame, 16);
        const auto rendered = [&](float descent) {
            return replicate(8, [&](std::uint64_t seed) {
                RenderSettings settings = LookSize{}.settings(IntegratorKind::kPhoton, seed);
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
        settings.gatherRays = 32;  // no pilot, so no guide of the rays
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
