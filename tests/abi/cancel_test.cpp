// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Work that is given up from another thread, in every phase that may take long. Times on the wall
// are shown, not judged: the machine may do other things at the same time; processor time is
// judged. PM_TRIANGLES=10000000 takes so large a mesh, PM_PHOTONS=20000000 so many photons,
// PM_TEXELS=8192 a picture of so many columns.
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <functional>
#include <iostream>
#include <map>
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

// Between a cancel and the call's return: 0.2 s of two threads.
constexpr double kMostProcessorSeconds = 0.4;

// A picture of 2 : 1, every texel of it another.
std::string writePicture(std::uint32_t columns) {
    const std::uint32_t rows = columns / 2;
    const std::string name = ::testing::TempDir() + "pm_cancel_" + std::to_string(columns) + ".ppm";
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
    PmrScene sceneOf(PmrMesh mesh, std::int32_t kind = PMR_MATERIAL_SURFACE) const {
        const PmrSceneDesc desc = PMR_INIT(PmrSceneDesc);
        PmrScene scene = nullptr;
        EXPECT_EQ(PMR_OK, api().createScene(context(), &desc, &scene));
        PmrMaterialDesc description = PMR_INIT(PmrMaterialDesc);
        description.kind = kind;
        PmrMaterial material = nullptr;
        EXPECT_EQ(PMR_OK, api().createMaterial(context(), &description, &material));
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
        const Clock::time_point first = Clock::now();
        ASSERT_EQ(PMR_OK, render(-1.0)) << m_host.lastError();
        const double whole = secondsSince(first);
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
    PmrTextureDesc picture = PMR_INIT(PmrTextureDesc);
    picture.fileName = "nowhere.tif";
    PmrTexture texture = nullptr;
    EXPECT_EQ(PMR_ERROR_CANCELLED, api().createTexture(context(), &picture, &texture));
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

// OpenSubdiv connects the faces in one piece.
TEST_F(Cancel, InsideConnectingACage) {
    const Sheet sheet(static_cast<std::uint32_t>(std::sqrt(numberOf("PM_TRIANGLES", 40000) / 4)));
    cancelWithin("a cage", [&] {
        PmrMesh mesh = nullptr;
        const PmrStatus status = makeCage(sheet, 1, mesh);
        if (status == PMR_OK) api().releaseMesh(mesh);
        return status;
    });
}

// OpenImageIO reads the picture, for the environment's table and for the scene's checksum.
TEST_F(Cancel, InsideReadingASky) {
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
TEST_F(Cancel, ACommitThatWasLeftBehindIsMadeAgain) {
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

// Photons, their maps, gather points, buckets: as they come.
TEST_F(Cancel, InsideAPass) {
    cancelRenders("a pass", m_host.scene(),
                  {{"photons", std::to_string(numberOf("PM_PHOTONS", 100000))},
                   {"passes", "1"},
                   {"width", "128"},
                   {"height", "96"},
                   {"aaLevel", "2"},
                   {"aaLevelMost", "2"}});
}

// Photons are aimed at every triangle that casts caustics.
TEST_F(Cancel, InsideAPassOverMuchGlass) {
    const Sheet sheet(static_cast<std::uint32_t>(std::sqrt(numberOf("PM_TRIANGLES", 200000) / 2)));
    PmrMesh mesh = nullptr;
    ASSERT_EQ(PMR_OK, makeMesh(sheet, mesh));
    const PmrScene scene = sceneOf(mesh, PMR_MATERIAL_DIELECTRIC);
    addGreyBall(context(), scene);
    PmrLightDesc lamp = PMR_INIT(PmrLightDesc);
    const double above[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 5};
    lamp.transforms = above;
    lamp.transformCount = 1;
    for (float& value : lamp.emission) value = 1.0f;
    ASSERT_EQ(PMR_OK, api().addLight(scene, &lamp));
    PmrCameraDesc camera = PMR_INIT(PmrCameraDesc);
    camera.transforms = above;
    camera.transformCount = 1;
    camera.fieldOfView = 1;
    ASSERT_EQ(PMR_OK, api().setCamera(scene, &camera));
    ASSERT_EQ(PMR_OK, api().commitScene(scene)) << m_host.lastError();
    cancelRenders("a pass over much glass", scene,
                  {{"photons", "10000"}, {"passes", "1"}, {"width", "64"}, {"height", "48"}});
    EXPECT_EQ(PMR_OK, api().releaseScene(scene));
    EXPECT_EQ(PMR_OK, api().releaseMesh(mesh));
}

}  // namespace

}  // namespace pm::test
