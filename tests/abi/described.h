// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// One object of each kind that has parameters by name.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "tests/abi/host.h"

namespace pm::test {

inline std::vector<PmrParameterInfo> parametersOf(std::int32_t object) {
    std::vector<PmrParameterInfo> found;
    for (std::uint32_t i = 0; i < api().parameterCount(object); ++i) {
        PmrParameterInfo info = PMR_INIT(PmrParameterInfo);
        EXPECT_EQ(PMR_OK, api().parameterInfo(object, i, &info));
        found.push_back(info);
    }
    return found;
}

// A ball below a light, an environment and a camera: one of all that has parameters.
class Described : public testing::Test {
  protected:
    void SetUp() override {
        ASSERT_EQ(PMR_OK, api().createContext(nullptr, &m_context));
        m_file = testing::TempDir() + "parameters_" + std::to_string(::getpid()) + ".pgm";
        std::ofstream(m_file, std::ios::binary) << "P5 2 2 255\n"
                                                << "a0Z~";
        PmrTextureDesc texture = PMR_INIT(PmrTextureDesc);
        texture.fileName = m_file.c_str();
        ASSERT_EQ(PMR_OK, api().createTexture(m_context, &texture, &m_texture)) << lastError();
        makeScene(PMR_INIT(PmrMaterialDesc));
    }
    void TearDown() override {
        releaseScene();
        EXPECT_EQ(PMR_OK, api().releaseTexture(m_texture));
        EXPECT_EQ(PMR_OK, api().releaseContext(m_context));
        std::remove(m_file.c_str());
    }
    void releaseScene() {
        if (m_scene == nullptr) return;
        EXPECT_EQ(PMR_OK, api().releaseScene(m_scene));
        EXPECT_EQ(PMR_OK, api().releaseMaterial(m_material));
        m_scene = nullptr;
    }

    std::string lastError() const {
        return textOf([this](char* buffer, std::uint64_t capacity, std::uint64_t* needed) {
            return api().lastError(m_context, buffer, capacity, needed);
        });
    }

    // A material and an empty scene.
    void makeScene(const PmrMaterialDesc& material) {
        releaseScene();
        ASSERT_EQ(PMR_OK, api().createMaterial(m_context, &material, &m_material)) << lastError();
        ASSERT_EQ(PMR_OK, api().createScene(m_context, nullptr, &m_scene));
    }
    // Of a unit sphere where the preset has no mesh; the mesh is given away.
    void addInstance(const PmrInstanceDesc& preset = PMR_INIT(PmrInstanceDesc)) {
        PmrSphereDesc sphere = PMR_INIT(PmrSphereDesc);
        sphere.radius = 1;
        PmrInstanceDesc instance = preset;
        if (instance.mesh == nullptr) {
            ASSERT_EQ(PMR_OK, api().createSphere(m_context, &sphere, &instance.mesh));
        }
        instance.materials = &m_material;
        instance.materialCount = 1;
        ASSERT_EQ(PMR_OK, api().addInstance(m_scene, &instance)) << lastError();
        EXPECT_EQ(PMR_OK, api().releaseMesh(instance.mesh));
    }
    void addCamera(const PmrCameraDesc* preset = nullptr) {
        const double transform[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 4};
        PmrCameraDesc camera = PMR_INIT(PmrCameraDesc);
        camera.fieldOfView = 0.8;
        camera.transforms = transform;
        camera.transformCount = 1;
        ASSERT_EQ(PMR_OK, api().setCamera(m_scene, preset == nullptr ? &camera : preset))
            << lastError();
    }
    // All of it, the light of a kind.
    void fill(std::int32_t lightKind) {
        PmrLightDesc light = PMR_INIT(PmrLightDesc);
        light.kind = lightKind;
        light.coneAngle = 3;
        for (float& value : light.emission) value = 10;
        PmrEnvironmentDesc environment = PMR_INIT(PmrEnvironmentDesc);
        for (float& value : environment.radiance) value = 0.5f;
        addInstance();
        ASSERT_EQ(PMR_OK, api().addLight(m_scene, &light)) << lastError();
        ASSERT_EQ(PMR_OK, api().setEnvironment(m_scene, &environment)) << lastError();
        addCamera();
    }

    PmrParameterDesc parameter(std::int32_t object, const char* name) const {
        PmrParameterDesc desc = PMR_INIT(PmrParameterDesc);
        desc.object = object;
        desc.material = object == PMR_OBJECT_MATERIAL ? m_material : nullptr;
        desc.scene = object == PMR_OBJECT_MATERIAL ? nullptr : m_scene;
        desc.name = name;
        return desc;
    }
    PmrStatus setNumbers(std::int32_t object, const char* name,
                         const std::vector<double>& numbers) const {
        PmrParameterDesc desc = parameter(object, name);
        desc.numbers = numbers.data();
        desc.numberCount = numbers.size();
        return api().setParameter(&desc);
    }
    PmrStatus setText(std::int32_t object, const char* name, const char* text) const {
        PmrParameterDesc desc = parameter(object, name);
        desc.text = text;
        return api().setParameter(&desc);
    }
    PmrStatus setTexture(std::int32_t object, const char* name) const {
        PmrParameterDesc desc = parameter(object, name);
        desc.texture = m_texture;
        return api().setParameter(&desc);
    }

    struct Result {
        std::string identity;  // of the scene
        std::vector<float> pixels;
    };
    Result render() const {
        Result result;
        EXPECT_EQ(PMR_OK, api().commitScene(m_scene)) << lastError();
        PmrRender render = nullptr;
        EXPECT_EQ(PMR_OK, api().createRender(m_scene, nullptr, &render));
        for (const char* side : {"width", "height"})
            EXPECT_EQ(PMR_OK, api().setSettingInteger(render, side, 8));
        EXPECT_EQ(PMR_OK, api().setSettingInteger(render, "passes", 1));
        EXPECT_EQ(PMR_OK, api().setSettingInteger(render, "photons", 100));
        EXPECT_EQ(PMR_OK, api().startRender(render)) << lastError();
        EXPECT_EQ(PMR_OK, api().waitRender(render, -1.0)) << lastError();
        result.pixels = readLayer(render, "beauty", 4, {0, 0, 8, 8});
        const std::string statistics =
            textOf([&](char* buffer, std::uint64_t capacity, std::uint64_t* needed) {
                return api().renderStatistics(render, buffer, capacity, needed);
            });
        result.identity = nlohmann::json::parse(statistics)["hashes"]["scene"];
        EXPECT_EQ(PMR_OK, api().destroyRender(render));
        return result;
    }

    std::string m_file;
    PmrContext m_context = nullptr;
    PmrTexture m_texture = nullptr;
    PmrMaterial m_material = nullptr;
    PmrScene m_scene = nullptr;
};

inline void expectSame(const std::vector<float>& expected, const std::vector<float>& found) {
    ASSERT_EQ(expected.size(), found.size());
    for (std::size_t i = 0; i < expected.size(); ++i) {
        ASSERT_FALSE(std::isnan(expected[i]));
        ASSERT_EQ(expected[i], found[i]) << i;
    }
}

}  // namespace pm::test
