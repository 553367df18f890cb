// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Builds that are given up from another thread, in every phase that may take long.
// PM_TRIANGLES=10000000 takes so large a mesh, PM_TEXELS=8192 a picture of so many columns.
#include "tests/abi/cancel.h"

#include <cmath>
#include <cstdio>
#include <functional>
#include <iostream>
#include <string>
#include <thread>
#include <vector>

namespace pm::test {

namespace {

// A picture of 2 : 1, every texel of it another.
std::string writePicture(std::uint32_t columns) {
    const std::uint32_t rows = columns / 2;
    const std::string name = ::testing::TempDir() + "pm_cancel_" + std::to_string(columns) + "." +
                             std::to_string(getpid()) + ".ppm";
    std::vector<unsigned char> texels;
    for (std::uint32_t i = 0; i < columns * rows; ++i)
        for (const std::uint32_t step : {1u, 7u, 31u})
            texels.push_back(static_cast<unsigned char>(1 + i * step % 255));
    std::FILE* file = std::fopen(name.c_str(), "wb");
    std::fprintf(file, "P6\n%u %u\n255\n", columns, rows);
    std::fwrite(texels.data(), 1, texels.size(), file);
    std::fclose(file);
    return name;
}

class CancelBuild : public Cancel {
  protected:
    // Does `work` once to the end, then cancels it after shares of the time that took. Returns how
    // often it came too late; prints the longest time that work went on for.
    void cancelWithin(const char* name, const std::function<PmrStatus()>& work) {
        const Clock::time_point first = Clock::now();
        ASSERT_EQ(PMR_OK, work()) << m_host.lastError();
        const double whole = secondsSince(first);
        int cancelled = 0;
        double longest = 0, most = 0;
        for (const double share : {0.0, 0.1, 0.25, 0.4, 0.55, 0.7, 0.85}) {
            Clock::time_point told;
            double processorTold = 0;
            std::thread other([&] {
                std::this_thread::sleep_for(std::chrono::duration<double>(share * whole));
                told = Clock::now();
                processorTold = processorSeconds();
                EXPECT_EQ(PMR_OK, api().cancelBuilds(context(), 1));
            });
            const PmrStatus status = work();
            const Clock::time_point ended = Clock::now();
            const double processorEnded = processorSeconds();
            other.join();
            EXPECT_EQ(PMR_OK, api().cancelBuilds(context(), 0));
            EXPECT_TRUE(status == PMR_OK || status == PMR_ERROR_CANCELLED) << m_host.lastError();
            if (status != PMR_ERROR_CANCELLED) continue;
            ++cancelled;
            longest = std::max(longest, std::chrono::duration<double>(ended - told).count());
            most = std::max(most, processorEnded - processorTold);
        }
        EXPECT_GE(cancelled, 1) << "of 7";
        EXPECT_LT(most, kMostProcessorSeconds);
        std::cout << name << ": " << whole << " s; " << cancelled
                  << " of 7 cancelled, the slowest after " << longest << " s, at most " << most
                  << " processor s\n";
    }
};

TEST_F(CancelBuild, BuildsMakeNothingAsLongAsItHolds) {
    EXPECT_EQ(PMR_ERROR_ARGUMENT, api().cancelBuilds(context(), 2));
    EXPECT_EQ(PMR_ERROR_HANDLE, api().cancelBuilds(nullptr, 1));
    const Sheet sheet(4);
    PmrMesh mesh = nullptr, none = nullptr;
    ASSERT_EQ(PMR_OK, makeMesh(sheet, mesh));
    const PmrScene scene = sceneOf(mesh);
    const PmrRender running = m_host.makeRender({{"passes", "4"}});
    EXPECT_EQ(PMR_OK, api().startRender(running)) << m_host.lastError();
    for (int i = 0; i < 2; ++i) EXPECT_EQ(PMR_OK, api().cancelBuilds(context(), 1));
    EXPECT_EQ(PMR_ERROR_CANCELLED, makeMesh(sheet, none));
    EXPECT_EQ(nullptr, none);
    EXPECT_EQ(PMR_ERROR_CANCELLED, makeCage(sheet, 2, none));
    EXPECT_EQ(nullptr, none);
    PmrTextureDesc picture = PMR_INIT(PmrTextureDesc);
    picture.fileName = "nowhere.tif";
    PmrTexture texture = nullptr;
    EXPECT_EQ(PMR_ERROR_CANCELLED, api().createTexture(context(), &picture, &texture));
    EXPECT_EQ(PMR_ERROR_CANCELLED, api().commitScene(scene));
    EXPECT_NE(std::string::npos, m_host.lastError().find("cancelled while"));
    double bounds[6];
    EXPECT_EQ(PMR_ERROR_STATE, api().sceneBounds(scene, bounds));
    // Other contexts, and renders that run, are not concerned; those that plan are, as often as it
    // takes.
    const BoxHost other;
    EXPECT_FALSE(renderBox(other, {{"passes", "1"}}).empty());
    EXPECT_EQ(PMR_OK, api().waitRender(running, -1.0)) << m_host.lastError();
    EXPECT_EQ(PMR_OK, api().destroyRender(running));
    const PmrRender planned = m_host.makeRender({{"passes", "1"}});
    std::int32_t delivery = 0;
    EXPECT_EQ(PMR_ERROR_CANCELLED, api().explainRender(planned, nullptr, 0, nullptr));
    EXPECT_EQ(PMR_ERROR_CANCELLED, api().renderDelivery(planned, &delivery));
    for (int i = 0; i < 2; ++i) EXPECT_EQ(PMR_ERROR_CANCELLED, api().startRender(planned));
    EXPECT_EQ(PMR_OK, api().cancelBuilds(context(), 0));
    EXPECT_EQ(PMR_OK, api().startRender(planned)) << m_host.lastError();
    EXPECT_EQ(PMR_OK, api().waitRender(planned, -1.0)) << m_host.lastError();
    EXPECT_EQ(PMR_OK, api().destroyRender(planned));
    EXPECT_EQ(PMR_OK, api().commitScene(scene)) << m_host.lastError();
    EXPECT_EQ(PMR_OK, api().sceneBounds(scene, bounds));
    EXPECT_EQ(PMR_OK, api().releaseScene(scene));
    EXPECT_EQ(PMR_OK, api().releaseMesh(mesh));
}

TEST_F(CancelBuild, InsideTriangulation) {
    const Sheet sheet(static_cast<std::uint32_t>(std::sqrt(numberOf("PM_TRIANGLES", 200000) / 2)));
    cancelWithin("triangulation", [&] {
        PmrMesh mesh = nullptr;
        const PmrStatus status = makeMesh(sheet, mesh);
        if (status == PMR_OK) api().releaseMesh(mesh);
        return status;
    });
}

TEST_F(CancelBuild, InsideTessellation) {
    constexpr std::uint32_t kRate = 16;
    const double faces = numberOf("PM_TRIANGLES", 200000) / (2.0 * kRate * kRate);
    const Sheet sheet(static_cast<std::uint32_t>(std::sqrt(faces)));
    cancelWithin("tessellation", [&] {
        PmrMesh mesh = nullptr;
        const PmrStatus status = makeCage(sheet, kRate, mesh);
        if (status == PMR_OK) api().releaseMesh(mesh);
        return status;
    });
}

TEST_F(CancelBuild, InsideCommit) {
    const Sheet sheet(static_cast<std::uint32_t>(std::sqrt(numberOf("PM_TRIANGLES", 200000) / 2)));
    PmrMesh mesh = nullptr;
    ASSERT_EQ(PMR_OK, makeMesh(sheet, mesh));
    cancelWithin("commit", [&] {
        const PmrScene scene = sceneOf(mesh);
        const PmrStatus status = api().commitScene(scene);
        EXPECT_EQ(PMR_OK, api().releaseScene(scene));
        return status;
    });
    EXPECT_EQ(PMR_OK, api().releaseMesh(mesh));
}

// OpenSubdiv connects the faces in one piece.
TEST_F(CancelBuild, InsideConnectingACage) {
    const Sheet sheet(static_cast<std::uint32_t>(std::sqrt(numberOf("PM_TRIANGLES", 40000) / 4)));
    cancelWithin("a cage", [&] {
        PmrMesh mesh = nullptr;
        const PmrStatus status = makeCage(sheet, 1, mesh);
        if (status == PMR_OK) api().releaseMesh(mesh);
        return status;
    });
}

// OpenImageIO reads the picture, for the environment's table and for the scene's checksum.
TEST_F(CancelBuild, InsideReadingASky) {
    const std::string file = writePicture(numberOf("PM_TEXELS", 512));
    PmrMesh mesh = nullptr;
    ASSERT_EQ(PMR_OK, makeMesh(Sheet(4), mesh));
    cancelWithin("a sky", [&] {
        PmrTextureDesc texture = PMR_INIT(PmrTextureDesc);
        texture.fileName = file.c_str();
        PmrEnvironmentDesc sky = PMR_INIT(PmrEnvironmentDesc);
        for (float& value : sky.radiance) value = 1.0f;
        const PmrScene scene = sceneOf(mesh);
        PmrStatus status = api().createTexture(context(), &texture, &sky.texture);
        if (status == PMR_OK) {
            EXPECT_EQ(PMR_OK, api().setEnvironment(scene, &sky));
            EXPECT_EQ(PMR_OK, api().releaseTexture(sky.texture));
            status = api().commitScene(scene);
        }
        EXPECT_EQ(PMR_OK, api().releaseScene(scene));
        return status;
    });
    EXPECT_EQ(PMR_OK, api().releaseMesh(mesh));
    std::remove(file.c_str());
}

// A scene whose commit was left behind is committed again, with more in it, and renders.
TEST_F(CancelBuild, ACommitThatWasLeftBehindIsMadeAgain) {
    const Sheet sheet(300);
    PmrMesh mesh = nullptr;
    ASSERT_EQ(PMR_OK, makeMesh(sheet, mesh));
    const PmrScene scene = sceneOf(mesh);
    for (int tries = 0; tries < 5; ++tries) {
        std::thread other([&] {
            std::this_thread::sleep_for(std::chrono::milliseconds(2 + 5 * tries));
            EXPECT_EQ(PMR_OK, api().cancelBuilds(context(), 1));
        });
        const PmrStatus status = api().commitScene(scene);
        other.join();
        EXPECT_EQ(PMR_OK, api().cancelBuilds(context(), 0));
        if (status == PMR_OK) break;
        EXPECT_EQ(PMR_ERROR_CANCELLED, status);
        addGreyBall(context(), scene);
    }
    const PmrStatus status = api().commitScene(scene);
    EXPECT_TRUE(status == PMR_OK || status == PMR_ERROR_STATE) << m_host.lastError();
    double bounds[6];
    EXPECT_EQ(PMR_OK, api().sceneBounds(scene, bounds));
    EXPECT_EQ(PMR_OK, api().releaseScene(scene));
    EXPECT_EQ(PMR_OK, api().releaseMesh(mesh));
}

}  // namespace

}  // namespace pm::test
