// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// What a render says of light that it has not found, and that it says so only then.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <vector>

#include "integrator/values/notice.h"
#include "tests/support/rooms.h"

namespace pm::test {
namespace {

std::vector<NoticeCode> noticesOf(const SceneMaker& maker) {
    RenderSettings settings = smallFrame(16, 16, IntegratorKind::kPhoton, 1, 2);
    settings.photons = 4000;
    const auto scene = maker.build();
    const Plan plan = makePlan(*scene, settings);
    FrameRenderer renderer(scene, settings, plan);
    renderer.beginPass(0, std::atomic<bool>{false}, {});
    std::vector<NoticeCode> codes;
    for (const Notice& notice : plan.notices) codes.push_back(notice.code);
    for (const Notice& notice : renderer.takeNotices()) codes.push_back(notice.code);
    return codes;
}

bool holds(const std::vector<NoticeCode>& codes, NoticeCode code) {
    return std::ranges::find(codes, code) != codes.end();
}

SceneMaker roomWithoutLamp() {
    SceneMaker maker = openRoom();
    maker.camera({0, 0, 3.9}, {0, 0, 0}, {0, 1, 0}, 37);
    return maker;
}

// A ceiling's lamp that faces away, out of the room.
void lampOutwards(SceneMaker& maker) {
    maker.quad({-0.2, 1.5, 0.2}, {0.4, 0, 0}, {0, 0, -0.4}, maker.diffuse({}, Rgb(10.0f)));
}

TEST(Notices, LightFromWithinGlassIsIndirectLightToo) {
    SceneMaker maker = roomWithoutLamp();
    maker.sphere({0, 0.2, 0}, 0.4, maker.material(glass()));
    maker.sphere({0, 0.2, 0}, 0.1, maker.diffuse({}, Rgb(50.0f)));
    EXPECT_TRUE(noticesOf(maker).empty());
    RenderSettings settings = smallFrame(16, 16, IntegratorKind::kPhoton, 4, 2);
    settings.photons = 4000;
    EXPECT_GT(measure(maker.build(), settings).indirect.mean[0], 0.01);
}

TEST(Notices, NoPhotonsWhereNoLightComes) {
    SceneMaker maker = roomWithoutLamp();
    lampOutwards(maker);
    EXPECT_EQ(noticesOf(maker), std::vector{NoticeCode::kNoPhotons});
    maker.sphere({0, -0.5, 0}, 0.3, maker.material(glass()));
    const std::vector<NoticeCode> codes = noticesOf(maker);
    EXPECT_TRUE(holds(codes, NoticeCode::kNoPhotons));
    EXPECT_TRUE(holds(codes, NoticeCode::kNoCausticPhotons));
}

TEST(Notices, NoCausticsWhereNoLightComesByGlass) {
    SceneMaker maker = roomWithoutLamp();
    ceilingLamp(maker, 0.2, Rgb(10.0f));
    maker.sphere({0, 50, 0}, 0.3, maker.material(glass()));
    const std::vector<NoticeCode> codes = noticesOf(maker);
    EXPECT_FALSE(holds(codes, NoticeCode::kNoPhotons));
    EXPECT_TRUE(holds(codes, NoticeCode::kNoCausticPhotons));
}

}  // namespace
}  // namespace pm::test
