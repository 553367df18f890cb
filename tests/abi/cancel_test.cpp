// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Work that is given up from another thread, in every phase that may take long. Times are shown,
// not judged: the machine may do other things at the same time. PM_TRIANGLES=10000000 takes so
// large a mesh, PM_PHOTONS=20000000 so many photons.
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <functional>
#include <iostream>
#include <thread>

#include "tests/abi/box_scene.h"
#include "tests/abi/host.h"

namespace pm::test {

namespace {

using Clock = std::chrono::steady_clock;

double secondsSince(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

// Of all threads: what work went on for, whatever else the machine does.
double processorSeconds() {
    std::timespec time{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

std::uint32_t numberOf(const char* variable, std::uint32_t usual) {
    const char* text = std::getenv(variable);
    return text == nullptr ? usual : static_cast<std::uint32_t>(std::strtoul(text, nullptr, 10));
}

// A bumpy sheet of quads, side x side of them.
struct Sheet {
    std::vector<float> positions;
    std::vector<std::uint32_t> indices, faceSizes;

    explicit Sheet(std::uint32_t side) : faceSizes(std::size_t{side} * side, 4) {
        for (std::uint32_t y = 0; y <= side; ++y)
            for (std::uint32_t x = 0; x <= side; ++x) {
                const float u = static_cast<float>(x) / static_cast<float>(side);
                const float v = static_cast<float>(y) / static_cast<float>(side);
                for (const float p : {u, v, 0.05f * std::sin(40.0f * u) * std::cos(37.0f * v)})
                    positions.push_back(p);
            }
        const std::uint32_t row = side + 1;
        for (std::uint32_t y = 0; y < side; ++y)
            for (std::uint32_t x = 0; x < side; ++x)
                for (const std::uint32_t corner : {0u, 1u, row + 1, row})
                    indices.push_back(y * row + x + corner);
    }
    PmrMeshDesc desc() const {
        PmrMeshDesc mesh = PMR_INIT(PmrMeshDesc);
        mesh.positions = positions.data();
        mesh.positionCount = positions.size() / 3;
        mesh.indices = indices.data();
        mesh.indexCount = indices.size();
        mesh.faceSizes = faceSizes.data();
        mesh.faceCount = faceSizes.size();
        return mesh;
    }
};

class Cancel : public ::testing::Test {
  protected:
    PmrContext context() const { return m_host.context(); }

    PmrStatus makeMesh(const Sheet& sheet, PmrMesh& mesh) const {
        const PmrMeshDesc desc = sheet.desc();
        return api().createMesh(context(), &desc, &mesh);
    }
    PmrStatus makeCage(const Sheet& sheet, std::uint32_t rate, PmrMesh& mesh) const {
        const PmrMeshDesc desc = sheet.desc();
        PmrCageDesc cage = PMR_INIT(PmrCageDesc);
        cage.mesh = &desc;
        cage.tessellationRate = rate;
        return api().createCage(context(), &cage, &mesh);
    }
    PmrScene sceneOf(PmrMesh mesh) const {
        const PmrSceneDesc desc = PMR_INIT(PmrSceneDesc);
        PmrScene scene = nullptr;
        EXPECT_EQ(PMR_OK, api().createScene(context(), &desc, &scene));
        const PmrMaterialDesc grey = PMR_INIT(PmrMaterialDesc);
        PmrMaterial material = nullptr;
        EXPECT_EQ(PMR_OK, api().createMaterial(context(), &grey, &material));
        const double identity[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
        PmrInstanceDesc instance = PMR_INIT(PmrInstanceDesc);
        instance.mesh = mesh;
        instance.transforms = identity;
        instance.transformCount = 1;
        instance.materials = &material;
        instance.materialCount = 1;
        EXPECT_EQ(PMR_OK, api().addInstance(scene, &instance)) << m_host.lastError();
        EXPECT_EQ(PMR_OK, api().releaseMaterial(material));
        return scene;
    }

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
        EXPECT_GE(cancelled, 3) << "of 7";
        std::cout << name << ": " << whole << " s; " << cancelled
                  << " of 7 cancelled, the slowest after " << longest << " s, at most " << most
                  << " processor s\n";
    }

    BoxHost m_host;
};

TEST_F(Cancel, BuildsMakeNothingAsLongAsItHolds) {
    EXPECT_EQ(PMR_ERROR_ARGUMENT, api().cancelBuilds(context(), 2));
    EXPECT_EQ(PMR_ERROR_HANDLE, api().cancelBuilds(nullptr, 1));
    const Sheet sheet(4);
    PmrMesh mesh = nullptr, none = nullptr;
    ASSERT_EQ(PMR_OK, makeMesh(sheet, mesh));
    const PmrScene scene = sceneOf(mesh);
    for (int i = 0; i < 2; ++i) EXPECT_EQ(PMR_OK, api().cancelBuilds(context(), 1));
    EXPECT_EQ(PMR_ERROR_CANCELLED, makeMesh(sheet, none));
    EXPECT_EQ(nullptr, none);
    EXPECT_EQ(PMR_ERROR_CANCELLED, makeCage(sheet, 2, none));
    EXPECT_EQ(nullptr, none);
    EXPECT_EQ(PMR_ERROR_CANCELLED, api().commitScene(scene));
    EXPECT_NE(std::string::npos, m_host.lastError().find("cancelled while"));
    double bounds[6];
    EXPECT_EQ(PMR_ERROR_STATE, api().sceneBounds(scene, bounds));
    // Other contexts, and renders of what is committed, are not concerned.
    const BoxHost other;
    EXPECT_FALSE(renderBox(other, {{"passes", "1"}}).empty());
    EXPECT_FALSE(renderBox(m_host, {{"passes", "1"}}).empty());
    EXPECT_EQ(PMR_OK, api().cancelBuilds(context(), 0));
    EXPECT_EQ(PMR_OK, api().commitScene(scene)) << m_host.lastError();
    EXPECT_EQ(PMR_OK, api().sceneBounds(scene, bounds));
    EXPECT_EQ(PMR_OK, api().releaseScene(scene));
    EXPECT_EQ(PMR_OK, api().releaseMesh(mesh));
}

TEST_F(Cancel, InsideTriangulation) {
    const Sheet sheet(static_cast<std::uint32_t>(std::sqrt(numberOf("PM_TRIANGLES", 200000) / 2)));
    cancelWithin("triangulation", [&] {
        PmrMesh mesh = nullptr;
        const PmrStatus status = makeMesh(sheet, mesh);
        if (status == PMR_OK) api().releaseMesh(mesh);
        return status;
    });
}

TEST_F(Cancel, InsideTessellation) {
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

TEST_F(Cancel, InsideCommit) {
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

// Photons, their maps, gather points, buckets: as they come.
TEST_F(Cancel, InsideAPass) {
    const std::string photons = std::to_string(numberOf("PM_PHOTONS", 100000));
    double most = 0;
    const auto render = [&](double cancelAfter, double& ended) {
        const PmrRender handle = m_host.makeRender({{"photons", photons},
                                                    {"passes", "1"},
                                                    {"width", "128"},
                                                    {"height", "96"},
                                                    {"aaLevel", "2"},
                                                    {"aaLevelMost", "2"}});
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
    double ended = 0, longest = 0;
    const Clock::time_point first = Clock::now();
    ASSERT_EQ(PMR_OK, render(-1.0, ended));
    const double whole = secondsSince(first);
    int cancelled = 0;
    constexpr int kTries = 10;
    for (int i = 0; i < kTries; ++i) {
        const PmrStatus status = render(whole * i / kTries, ended);
        EXPECT_TRUE(status == PMR_OK || status == PMR_ERROR_CANCELLED);
        if (status != PMR_ERROR_CANCELLED) continue;
        ++cancelled;
        longest = std::max(longest, ended);
    }
    EXPECT_GE(cancelled, kTries / 2);
    std::cout << "a pass: " << whole << " s; " << cancelled << " of " << kTries
              << " cancelled, the slowest after " << longest << " s, at most " << most
              << " processor s\n";
}

}  // namespace

}  // namespace pm::test
