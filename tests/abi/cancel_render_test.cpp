// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Renders that are given up from another thread, in every phase that may take long.
// PM_TRIANGLES=10000000 takes so large a mesh, PM_PHOTONS=20000000 so many photons.
#include <cmath>
#include <iostream>
#include <map>
#include <string>
#include <utility>

#include "tests/abi/cancel.h"

namespace pm::test {

namespace {

#if defined(PM_ADDRESS_SANITIZER) || defined(PM_THREAD_SANITIZER)
constexpr double kMostStartSeconds = 10;
#else
constexpr double kMostStartSeconds = 0.1;
#endif

double secondsOfThisThread() {
    std::timespec time{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

const std::map<std::string, std::string> kSmallPass = {
    {"photons", "10000"}, {"passes", "1"}, {"width", "64"}, {"height", "48"}};

PmrMaterialDesc lamp() {
    PmrMaterialDesc material = PMR_INIT(PmrMaterialDesc);
    for (float& value : material.emission) value = 1.0f;
    return material;
}

class CancelRender : public Cancel {
  protected:
    // A sheet under a lamp, a ball, a camera, committed.
    PmrScene litSheet(const PmrMaterialDesc& material) const {
        const Sheet sheet(
            static_cast<std::uint32_t>(std::sqrt(numberOf("PM_TRIANGLES", 200000) / 2)));
        PmrMesh mesh = nullptr;
        EXPECT_EQ(PMR_OK, makeMesh(sheet, mesh));
        const PmrScene scene = sceneOf(mesh, material);
        EXPECT_EQ(PMR_OK, api().releaseMesh(mesh));
        addGreyBall(context(), scene);
        PmrLightDesc light = PMR_INIT(PmrLightDesc);
        const double above[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 5};
        light.transforms = above;
        light.transformCount = 1;
        for (float& value : light.emission) value = 1.0f;
        EXPECT_EQ(PMR_OK, api().addLight(scene, &light));
        PmrCameraDesc camera = PMR_INIT(PmrCameraDesc);
        camera.transforms = above;
        camera.transformCount = 1;
        camera.fieldOfView = 1;
        EXPECT_EQ(PMR_OK, api().setCamera(scene, &camera));
        EXPECT_EQ(PMR_OK, api().commitScene(scene)) << m_host.lastError();
        return scene;
    }

    // Cancels renders of the scene at even moments of the time that one takes.
    void cancelRenders(const char* name, PmrScene scene,
                       const std::map<std::string, std::string>& settings) {
        double ended = 0, most = 0, longest = 0;
        const auto render = [&](double cancelAfter) {
            PmrRender handle = nullptr;
            EXPECT_EQ(PMR_OK, api().createRender(scene, nullptr, &handle));
            for (const auto& [key, value] : settings)
                EXPECT_EQ(PMR_OK, api().setSettingText(handle, key.c_str(), value.c_str()));
            EXPECT_EQ(PMR_OK, api().startRender(handle)) << m_host.lastError();
            PmrStatus status = api().waitRender(handle, cancelAfter);
            const Clock::time_point told = Clock::now();
            const double processorTold = processorSeconds();
            if (status == PMR_ERROR_TIMEOUT) {
                EXPECT_EQ(PMR_OK, api().cancelRender(handle));
                status = api().waitRender(handle, -1.0);
            }
            ended = secondsSince(told);
            if (status == PMR_ERROR_CANCELLED)
                most = std::max(most, processorSeconds() - processorTold);
            EXPECT_EQ(PMR_OK, api().destroyRender(handle));
            return status;
        };
        // The first of all takes longer than those after it.
        double whole = 1e9;
        for (int i = 0; i < 2; ++i) {
            const Clock::time_point begin = Clock::now();
            ASSERT_EQ(PMR_OK, render(-1.0)) << m_host.lastError();
            whole = std::min(whole, secondsSince(begin));
        }
        int cancelled = 0;
        constexpr int kTries = 10;
        for (int i = 0; i < kTries; ++i) {
            const PmrStatus status = render(whole * i / kTries);
            EXPECT_TRUE(status == PMR_OK || status == PMR_ERROR_CANCELLED);
            if (status != PMR_ERROR_CANCELLED) continue;
            ++cancelled;
            longest = std::max(longest, ended);
        }
        EXPECT_GE(cancelled, kTries / 2);
        EXPECT_LT(most, kMostProcessorSeconds);
        std::cout << name << ": " << whole << " s; " << cancelled << " of " << kTries
                  << " cancelled, the slowest after " << longest << " s, at most " << most
                  << " processor s\n";
    }
};

// Photons, their maps, gather points, buckets: as they come.
TEST_F(CancelRender, InsideAPass) {
    cancelRenders("a pass", m_host.scene(),
                  {{"photons", std::to_string(numberOf("PM_PHOTONS", 100000))},
                   {"passes", "1"},
                   {"width", "128"},
                   {"height", "96"},
                   {"aaLevel", "2"},
                   {"aaLevelMost", "2"}});
}

// Photons are aimed at every triangle that casts caustics.
TEST_F(CancelRender, InsideAPassOverMuchGlass) {
    PmrMaterialDesc glass = PMR_INIT(PmrMaterialDesc);
    glass.kind = PMR_MATERIAL_DIELECTRIC;
    const PmrScene scene = litSheet(glass);
    cancelRenders("a pass over much glass", scene, kSmallPass);
    EXPECT_EQ(PMR_OK, api().releaseScene(scene));
}

// Every triangle is a lamp, and they learn where they reach.
TEST_F(CancelRender, InsideAPassWithManyLamps) {
    const PmrScene scene = litSheet(lamp());
    cancelRenders("a pass with many lamps", scene, kSmallPass);
    EXPECT_EQ(PMR_OK, api().releaseScene(scene));
}

// Whatever the number of triangles, lamps and pixels: what takes long begins after startRender has
// returned, where a cancel reaches it.
TEST_F(CancelRender, StartReturnsAtOnce) {
    for (const PmrMaterialDesc& material : {PMR_INIT(PmrMaterialDesc), lamp()}) {
        const PmrScene scene = litSheet(material);
        // The least of three: half of it is the system's, for memory, and slow on a busy machine.
        double least = 1e9;
        for (int i = 0; i < 3; ++i) {
            PmrRender render = nullptr;
            ASSERT_EQ(PMR_OK, api().createRender(scene, nullptr, &render));
            for (const auto& [name, pixels] : {std::pair("width", 2048), std::pair("height", 1536)})
                ASSERT_EQ(PMR_OK, api().setSettingInteger(render, name, pixels));
            const double before = secondsOfThisThread();
            EXPECT_EQ(PMR_OK, api().startRender(render)) << m_host.lastError();
            least = std::min(least, secondsOfThisThread() - before);
            EXPECT_EQ(PMR_OK, api().destroyRender(render));
        }
        EXPECT_LT(least, kMostStartSeconds);
        std::cout << "startRender: " << least << " processor s\n";
        EXPECT_EQ(PMR_OK, api().releaseScene(scene));
    }
}

}  // namespace

}  // namespace pm::test
