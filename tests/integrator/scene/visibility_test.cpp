// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Instances that are hidden from the camera, from shadow rays, or from all others.
#include <gtest/gtest.h>

#include <cstdint>

#include "tests/support/rooms.h"
#include "tests/support/scene_maker.h"

namespace pm::test {
namespace {

constexpr IntegratorKind kIntegrators[] = {IntegratorKind::kPhoton, IntegratorKind::kPath};

// What was added last.
void hide(SceneMaker& maker, Viewers from) {
    maker.description.instances.back().hiddenFrom = from;
}

// A floor under a lamp that fills much of its sky, so that rays along the lobe find it as well, and
// something black between them.
SceneMaker shadedFloor(Viewers blockerHiddenFrom, Viewers lampHiddenFrom, bool withBlocker = true) {
    SceneMaker maker;
    maker.quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, maker.diffuse(Rgb(0.5f)));
    maker.quad({-2, -2, 2}, {0, 4, 0}, {4, 0, 0}, maker.diffuse({}, Rgb(3.0f)));
    hide(maker, lampHiddenFrom);
    if (withBlocker) {
        maker.quad({-3, -3, 1}, {6, 0, 0}, {0, 6, 0}, maker.diffuse({}));
        hide(maker, blockerHiddenFrom);
    }
    maker.camera({0, -0.9, 0.5}, {0, 0, 0}, {0, 0, 1}, 40);
    return maker;
}

MeasuredLayers render(const SceneMaker& maker, IntegratorKind integrator,
                      std::uint32_t passes = 16) {
    return measure(maker.build(), smallFrame(16, 16, integrator, passes, 2));
}

TEST(Visibility, WhatIsHiddenFromShadowsCastsNone) {
    for (const IntegratorKind integrator : kIntegrators) {
        const MeasuredLayers open = render(shadedFloor(0, 0, false), integrator);
        ASSERT_GT(open.direct.mean[0], 0.1);
        EXPECT_TRUE(
            agree(render(shadedFloor(kShadowRays, 0), integrator).direct, open.direct, 1e-5));
        EXPECT_EQ(render(shadedFloor(0, 0), integrator).direct.mean[0], 0.0);
        // It does not matter to shadows that others pass it.
        EXPECT_EQ(render(shadedFloor(kReflectionRays, 0), integrator).direct.mean[0], 0.0);
        EXPECT_EQ(render(shadedFloor(kCameraRays, 0), integrator).direct.mean[0], 0.0);
        EXPECT_TRUE(agree(render(shadedFloor(kShadowRays | kReflectionRays, 0), integrator).direct,
                          open.direct, 1e-5));
    }
}

// A lamp shines as before, whoever does not see it.
TEST(Visibility, HiddenLampsShine) {
    for (const IntegratorKind integrator : kIntegrators) {
        const MeasuredLayers open = render(shadedFloor(0, 0, false), integrator);
        for (Viewers hidden = 1; hidden < 8; ++hidden)
            EXPECT_TRUE(
                agree(render(shadedFloor(0, hidden, false), integrator).direct, open.direct, 1e-5))
                << hidden;
    }
}

// Seen straight, and in a mirror.
TEST(Visibility, TheCameraAndItsMirrors) {
    for (const IntegratorKind integrator : kIntegrators)
        for (const bool inMirror : {false, true})
            for (Viewers hidden = 0; hidden < 8; ++hidden) {
                SceneMaker maker;
                if (inMirror)
                    maker.quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, maker.material(mirror(1.0f)));
                const double height = inMirror ? 3 : 0;
                maker.quad({-2, -2, height}, {inMirror ? 0.0 : 4.0, inMirror ? 4.0 : 0.0, 0},
                           {inMirror ? 4.0 : 0.0, inMirror ? 0.0 : 4.0, 0},
                           maker.diffuse({}, Rgb(1.0f)));
                hide(maker, hidden);
                maker.quad({-9, -9, 9}, {18, 0, 0}, {0, 18, 0}, maker.diffuse({}));
                maker.camera({0, 0, 1}, {0, 0, 0}, {0, 1, 0}, 30);
                const bool isHidden = (hidden & (inMirror ? kReflectionRays : kCameraRays)) != 0;
                EXPECT_NEAR(render(maker, integrator, 2).emission.mean[0], isHidden ? 0.0 : 1.0,
                            1e-5)
                    << inMirror << ' ' << hidden;
            }
}

// Light that goes to and fro, and through glass, past a ball that is hidden from some: photons know
// of it what paths do.
TEST(Visibility, PhotonsAndPathsAgree) {
    for (const Viewers hidden : {kShadowRays, kReflectionRays, kShadowRays | kReflectionRays}) {
        SceneMaker maker = openRoom();
        ceilingLamp(maker, 0.4, Rgb(5.0f));
        maker.sphere({0.1, 0.3, 0}, 0.4, maker.diffuse(Rgb(0.6f)));
        hide(maker, hidden);
        maker.sphere({-0.5, -0.65, 0.2}, 0.3, maker.material(glass()));
        const auto scene = maker.build();
        const MeasuredLayers photon =
            measure(scene, smallFrame(16, 16, IntegratorKind::kPhoton, 16, 2));
        const MeasuredLayers path =
            measure(scene, smallFrame(16, 16, IntegratorKind::kPath, 40, 4));
        EXPECT_TRUE(agree(photon.direct, path.direct, 1e-3)) << hidden;
        EXPECT_TRUE(agree(photon.indirect, path.indirect, 0.02)) << hidden;
        EXPECT_TRUE(agree(photon.caustic, path.caustic, 0.1)) << hidden;
        EXPECT_TRUE(agree(photon.emission, path.emission, 1e-3)) << hidden;
    }
}

}  // namespace
}  // namespace pm::test
