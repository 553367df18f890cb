// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// What the tests of cancelling share. Times on the wall are shown, not judged: the machine may do
// other things at the same time; processor time is judged.
#pragma once

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <ctime>

#include "tests/abi/box_scene.h"
#include "tests/abi/host.h"

namespace pm::test {

using Clock = std::chrono::steady_clock;

inline double secondsSince(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

// Of all threads: what work went on for, whatever else the machine does.
inline double processorSeconds() {
    std::timespec time{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

inline std::uint32_t numberOf(const char* variable, std::uint32_t usual) {
    const char* text = std::getenv(variable);
    return text == nullptr ? usual : static_cast<std::uint32_t>(std::strtoul(text, nullptr, 10));
}

// Between a cancel and the call's return: 0.2 s of two threads.
inline constexpr double kMostProcessorSeconds = 0.4;

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
    PmrScene sceneOf(PmrMesh mesh,
                     const PmrMaterialDesc& description = PMR_INIT(PmrMaterialDesc)) const {
        const PmrSceneDesc desc = PMR_INIT(PmrSceneDesc);
        PmrScene scene = nullptr;
        EXPECT_EQ(PMR_OK, api().createScene(context(), &desc, &scene));
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

    BoxHost m_host;
};

}  // namespace pm::test
