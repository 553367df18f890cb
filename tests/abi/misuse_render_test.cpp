// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Renders with wrong settings, in wrong states, of scenes that can't be rendered.
#include <limits>

#include "tests/abi/host.h"

namespace pm::test {

namespace {

TEST(MisuseRender, SceneMustBeCommitted) {
    const BoxHost host;
    PmrScene scene = nullptr;
    PmrRender render = nullptr;
    double bounds[6];
    ASSERT_EQ(PMR_OK, api().createScene(host.context(), nullptr, &scene));
    EXPECT_EQ(PMR_ERROR_STATE, api().createRender(scene, nullptr, &render));
    EXPECT_EQ(PMR_ERROR_STATE, api().sceneBounds(scene, bounds));
    EXPECT_EQ(nullptr, render);
    EXPECT_EQ(PMR_OK, api().releaseScene(scene));
    EXPECT_EQ(PMR_OK, api().sceneBounds(host.scene(), bounds));
    const double expected[6] = {-1, -1, -1, 1, 1, 1};
    for (int i = 0; i < 6; ++i) EXPECT_NEAR(expected[i], bounds[i], 1e-6);
}

TEST(MisuseRender, Descriptions) {
    const BoxHost host;
    PmrRender render = nullptr;
    PmrRenderDesc desc = PMR_INIT(PmrRenderDesc);
    desc.callbackMode = 2;
    EXPECT_EQ(PMR_ERROR_ARGUMENT, api().createRender(host.scene(), &desc, &render));
}

TEST(MisuseRender, Calls) {
    const BoxHost host;
    const PmrRender render = host.makeRender({});
    const PmrRectangle one = {0, 0, 1, 1};
    float pixel[4] = {};
    const double nan = std::numeric_limits<double>::quiet_NaN();
    std::uint64_t needed = 0;
    EXPECT_EQ(PMR_ERROR_STATE, api().renderStatistics(render, nullptr, 0, &needed));
    EXPECT_EQ(PMR_ERROR_ARGUMENT, api().setSettingText(render, nullptr, "1"));
    EXPECT_EQ(PMR_ERROR_ARGUMENT, api().setSettingText(render, "width", nullptr));
    EXPECT_EQ(PMR_ERROR_NAME, api().setSettingText(render, "colour of the sky", "1"));
    EXPECT_EQ(PMR_ERROR_NAME, api().settingText(render, "", nullptr, 0, &needed));
    EXPECT_EQ(PMR_ERROR_ARGUMENT, api().renderLayerCount(render, nullptr));
    EXPECT_EQ(PMR_ERROR_ARGUMENT, api().waitRender(render, nan));
    EXPECT_EQ(PMR_ERROR_ARGUMENT, api().pollRender(render, nan));
    EXPECT_EQ(PMR_ERROR_ARGUMENT, api().readPixels(render, nullptr, "beauty", pixel, 0, 0));
    EXPECT_EQ(PMR_ERROR_ARGUMENT, api().readPixels(render, &one, nullptr, pixel, 0, 0));
    EXPECT_EQ(PMR_ERROR_ARGUMENT, api().readPixels(render, &one, "beauty", nullptr, 0, 0));
    EXPECT_EQ(PMR_ERROR_NAME, api().readPixels(render, &one, "albedo", pixel, 0, 0));
    EXPECT_EQ(PMR_ERROR_NAME, api().readPixels(render, &one, "bokeh", pixel, 0, 0));
    EXPECT_EQ(PMR_ERROR_ARGUMENT, api().readPixels(render, &one, "beauty", pixel, 8, 0));
    EXPECT_EQ(PMR_ERROR_ARGUMENT,
              api().readPixels(render, &one, "beauty", pixel, INT64_MIN + 1, 0));
    for (const PmrRectangle bad :
         {PmrRectangle{3, 0, 1, 1}, PmrRectangle{INT32_MIN, 0, INT32_MAX, 1}})
        EXPECT_EQ(PMR_ERROR_ARGUMENT, api().readPixels(render, &bad, "beauty", pixel, 0, 0));
    EXPECT_EQ(PMR_OK, api().renderState(render, nullptr, nullptr));
    EXPECT_EQ(PMR_OK, api().destroyRender(render));
}

TEST(MisuseRender, MemoryLimitRefusesBeforeAnyRay) {
    const BoxHost host;
    const PmrRender render =
        host.makeRender({{"width", "8000"}, {"height", "8000"}, {"memoryLimitGib", "0.5"}});
    EXPECT_EQ(PMR_ERROR_MEMORY, api().startRender(render));
    EXPECT_NE(std::string::npos, host.lastError().find("limit is 0.50 GiB")) << host.lastError();
    std::int32_t state = 9;
    EXPECT_EQ(PMR_OK, api().renderState(render, &state, nullptr));
    EXPECT_EQ(PMR_RENDER_CREATED, state);
    EXPECT_EQ(PMR_OK, api().setSettingInteger(render, "width", 16));  // and it can be put right
    EXPECT_EQ(PMR_OK, api().setSettingInteger(render, "height", 16));
    EXPECT_EQ(PMR_OK, api().startRender(render)) << host.lastError();
    EXPECT_EQ(PMR_OK, api().waitRender(render, -1));
    EXPECT_EQ(PMR_OK, api().destroyRender(render));
}

// An explanation of a run that startRender refuses would be one of another render.
TEST(MisuseRender, RunsThatAreNotThereAreNotExplained) {
    const BoxHost host;
    std::uint64_t needed = 0;
    for (const std::map<std::string, std::string>& settings :
         {std::map<std::string, std::string>{{"buckets", "900:901"}},
          std::map<std::string, std::string>{{"buckets", "1/2"}, {"bucketOrder", "correlated"}},
          std::map<std::string, std::string>{{"buckets", "1/2"}, {"errorTarget", "0.1"}}}) {
        const PmrRender render = host.makeRender(settings);
        EXPECT_EQ(PMR_ERROR_ARGUMENT, api().explainRender(render, nullptr, 0, &needed));
        const std::string explained = host.lastError();
        EXPECT_EQ(PMR_ERROR_ARGUMENT, api().startRender(render));
        EXPECT_EQ(explained, host.lastError());
        EXPECT_TRUE(explained.starts_with("setting buckets ")) << explained;
        EXPECT_EQ(PMR_OK, api().setSettingText(render, "buckets", ""));
        EXPECT_EQ(PMR_OK, api().explainRender(render, nullptr, 0, &needed)) << host.lastError();
        EXPECT_EQ(PMR_OK, api().destroyRender(render));
    }
}

TEST(MisuseRender, HugeSettingsAreRefused) {
    const BoxHost host;
    for (const std::map<std::string, std::string>& settings :
         {std::map<std::string, std::string>{{"width", "65536"}, {"height", "65536"}},
          std::map<std::string, std::string>{{"photons", "4000000000"}, {"memoryLimitGib", "1"}}}) {
        const PmrRender render = host.makeRender(settings);
        EXPECT_EQ(PMR_ERROR_MEMORY, api().startRender(render));
        EXPECT_EQ(PMR_OK, api().destroyRender(render));
    }
}

TEST(MisuseRender, SceneWithoutCamera) {
    const BoxHost host;
    PmrScene scene = nullptr;
    PmrRender render = nullptr;
    ASSERT_EQ(PMR_OK, api().createScene(host.context(), nullptr, &scene));
    EXPECT_EQ(PMR_ERROR_SCENE, api().commitScene(scene));
    EXPECT_NE(std::string::npos, host.lastError().find("no geometry")) << host.lastError();
    addGreyBall(host.context(), scene);
    ASSERT_EQ(PMR_OK, api().commitScene(scene)) << host.lastError();
    ASSERT_EQ(PMR_OK, api().createRender(scene, nullptr, &render));
    EXPECT_EQ(PMR_ERROR_SCENE, api().startRender(render)) << host.lastError();
    EXPECT_NE(std::string::npos, host.lastError().find("camera")) << host.lastError();
    EXPECT_EQ(PMR_OK, api().destroyRender(render));
    EXPECT_EQ(PMR_OK, api().releaseScene(scene));
}

}  // namespace

}  // namespace pm::test
