// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// A room beside things that are a million times as far away as it is wide: the same light in it,
// and no word of what is not so.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "integrator/scene/scene_core.h"
#include "tests/support/scene_maker.h"

namespace pm::test {
namespace {

using Add = std::function<void(SceneMaker&)>;

// A closed room of width 2 around `at`, with a lamp close under its ceiling and a ball of glass.
SceneMaker room(const Vec3d& at = {}) {
    SceneMaker maker;
    maker.box(at + Vec3d{-1, -1, -1}, at + Vec3d{1, 1, 1}, maker.diffuse(Rgb(0.5f)), true);
    maker.quad(at + Vec3d{-0.3, 0.99, -0.3}, {0.6, 0, 0}, {0, 0, 0.6},
               maker.diffuse({}, Rgb(10.0f)));
    MaterialDescription glass;
    glass.kind = MaterialKind::kDielectric;
    maker.sphere(at + Vec3d{0.4, -0.6, -0.3}, 0.25, maker.material(glass));
    maker.camera(at + Vec3d{0, 0, 0.9}, at, {0, 1, 0}, 60);
    return maker;
}

void addStray(SceneMaker& maker, const Vec3d& at) {
    maker.quad(at - Vec3d{0, 1, 1}, {0, 2, 0}, {0, 0, 2}, maker.diffuse(Rgb(0.5f)));
}

MeasuredLayers lightOf(const SceneMaker& maker) {
    RenderSettings settings = smallFrame(16, 16, IntegratorKind::kPhoton, 4, 2);
    settings.photons = 20'000;
    return measure(maker.build(), settings);
}

void expectSame(const Add& add, const MeasuredLayers& want, const std::string& what) {
    SceneMaker maker = room();
    add(maker);
    const MeasuredLayers got = lightOf(maker);
    EXPECT_TRUE(agree(got.direct, want.direct, 2e-3)) << what;
    EXPECT_TRUE(agree(got.indirect, want.indirect, 1e-2)) << what;
    EXPECT_TRUE(agree(got.caustic, want.caustic, 2e-2)) << what;
    EXPECT_TRUE(agree(got.beauty, want.beauty, 5e-3)) << what;
}

TEST(FarObject, LeavesTheRoomAsItIs) {
    const MeasuredLayers want = lightOf(room());
    for (const double far : {3e3, 1e5, 1e7, 1e9}) {
        expectSame(
            [&](SceneMaker& m) {
                addStray(m, {far, 0, 0});
            },
            want, "one, " + std::to_string(far));
        expectSame(
            [&](SceneMaker& m) {
                addStray(m, {far, 0, 0});
                addStray(m, {-far, 0.3 * far, 0});
                addStray(m, {0, 0, 0.01 * far});
            },
            want, "on both sides and near, " + std::to_string(far));
    }
    // As many triangles as one likes: what counts is where the camera is.
    expectSame(
        [&](SceneMaker& m) {
            m.meshSphere({0, 1e7, 2e6}, 3, m.diffuse(Rgb(0.5f)), false, 20);
        },
        want, "a fine mesh");
    // A thing that is large itself, and a lamp.
    expectSame(
        [&](SceneMaker& m) {
            m.quad({-3e6, 1e7, -3e6}, {6e6, 0, 0}, {0, 0, 6e6}, m.diffuse({}, Rgb(1.0f)));
        },
        want, "a lamp");
}

TEST(FarObject, IsToldWhereDigitsEnd) {
    for (const double far : {1e5, 1e7}) {
        SceneMaker maker = room();
        addStray(maker, {far, 0, 0});
        EXPECT_TRUE(maker.build()->notices().empty()) << far;
    }
    SceneMaker maker = room();
    addStray(maker, {1e9, 0, 0});
    const auto notices = maker.build()->notices();
    ASSERT_EQ(notices.size(), 1u);
    EXPECT_EQ(notices[0].code, NoticeCode::kDegenerateGeometry);
    EXPECT_NE(notices[0].text.find("placed to 6e+01"), std::string::npos) << notices[0].text;
}

// A sun's photons start beyond all there is; what is between still shades.
TEST(FarObject, SunlightComesFromBeyondIt) {
    const auto scene = [](bool far, bool shade) {
        SceneMaker maker;
        maker.quad({-1, 0, 1}, {2, 0, 0}, {0, 0, -2}, maker.diffuse(Rgb(0.5f)));
        maker.quad({-1, 0, -1}, {2, 0, 0}, {0, 1, 0}, maker.diffuse(Rgb(0.5f)));
        if (far) addStray(maker, {1e7, 0, 0});
        if (shade)
            maker.quad({-1e6, 2e7, -1e6}, {2e6, 0, 0}, {0, 0, 2e6}, maker.diffuse(Rgb(0.0f)));
        maker.sun({0, -1, 0}, Rgb(1.0f), 0);
        maker.camera({0, 1, 2}, {0, 0, 0}, {0, 1, 0}, 40);
        return maker;
    };
    const MeasuredLayers want = lightOf(scene(false, false)), got = lightOf(scene(true, false));
    EXPECT_TRUE(agree(got.direct, want.direct, 2e-3));
    EXPECT_TRUE(agree(got.indirect, want.indirect, 3e-2));
    EXPECT_EQ(lightOf(scene(true, true)).beauty.mean[0], 0);
}

// A camera a million units away that sees a room of width 2.
TEST(FarObject, IsSeenByAFarCamera) {
    const auto from = [](double far, double stray) {
        SceneMaker maker;
        maker.quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, maker.diffuse(Rgb(0.5f)));
        maker.pointLight({0, 0, 1}, Rgb(1.0f));
        if (stray > 0) addStray(maker, {0, 0, -stray});
        maker.camera({0, 0, far}, {0, 0, 0}, {0, 1, 0}, 2 * std::atan(1 / far) * 57.29577951);
        return lightOf(maker).direct;
    };
    const Measured want = from(1e3, 0);
    EXPECT_TRUE(agree(from(1e6, 0), want, 5e-3));
    EXPECT_TRUE(agree(from(1e6, 1e7), want, 5e-3));
}

// Cores: what lies together, far less wide than the whole.
TEST(SceneCore, IsWhatLiesTogether) {
    const auto coreOf = [](const std::vector<Box3d>& boxes, std::optional<Vec3d> eye) {
        Box3d whole;
        for (const Box3d& box : boxes) whole.grow(box);
        return findCore(
            whole,
            [&](const auto& visit) {
                for (const Box3d& box : boxes) visit(box);
            },
            eye);
    };
    const auto cube = [](const Vec3d& at, double half) {
        return Box3d{at - Vec3d(half), at + Vec3d(half)};
    };
    const std::vector<Box3d> rooms = {cube({0, 0, 0}, 1), cube({0.5, 0, 0}, 1),
                                      cube({1e6, 0, 0}, 1)};
    const auto most = coreOf(rooms, {}), near = coreOf(rooms, Vec3d{9e5, 1e3, 0});
    ASSERT_TRUE(most && near);
    EXPECT_EQ(most->middle().x, 0.25);
    EXPECT_EQ(near->middle().x, 1e6);
    // None: all together; evenly spread; or only ten times as wide.
    EXPECT_FALSE(coreOf({cube({}, 1), cube({2, 1, 0}, 1)}, {}));
    EXPECT_FALSE(coreOf({cube({}, 1), cube({20, 1, 0}, 1)}, {}));
    std::vector<Box3d> town;
    for (int i = 0; i < 100; ++i) town.push_back(cube({1e4 * i, 0, 0}, 1));
    EXPECT_FALSE(coreOf(town, Vec3d{1e4, 0, 0}));
    // A ground to the horizon is no part of it.
    const auto onGround = coreOf({{{-1e6, 0, -1e6}, {1e6, 0, 1e6}}, cube({4e5, 1, 0}, 1)}, {});
    ASSERT_TRUE(onGround);
    EXPECT_EQ(onGround->middle().x, 4e5);
}

}  // namespace
}  // namespace pm::test
