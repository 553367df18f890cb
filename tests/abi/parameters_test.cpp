// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Parameters by name: the same scene as by structs, in bits and in identity; what is not allowed is
// refused with the range or the names; and each that changes pixels changes the identity.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <functional>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "tests/abi/host.h"

namespace pm::test {

namespace {

std::vector<PmrParameterInfo> parametersOf(std::int32_t object) {
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

void expectSame(const std::vector<float>& expected, const std::vector<float>& found) {
    ASSERT_EQ(expected.size(), found.size());
    for (std::size_t i = 0; i < expected.size(); ++i) {
        ASSERT_FALSE(std::isnan(expected[i]));
        ASSERT_EQ(expected[i], found[i]) << i;
    }
}

TEST_F(Described, MaterialByNameEqualsByStruct) {
    PmrMaterialDesc desc = PMR_INIT(PmrMaterialDesc);
    desc.kind = PMR_MATERIAL_SURFACE;
    desc.diffuse[0] = 0.3f;
    desc.diffuse[2] = 0.25f;
    desc.glossy[1] = 0.1f;
    desc.glossyExponent = 20;
    desc.transparency = 0.2f;
    desc.emission[0] = 0.7f;
    desc.diffuseTexture = m_texture;
    makeScene(desc);
    fill(PMR_LIGHT_POINT);
    const Result expected = render();
    makeScene(PMR_INIT(PmrMaterialDesc));
    const std::int32_t material = PMR_OBJECT_MATERIAL;
    EXPECT_EQ(PMR_OK, setText(material, "kind", "surface"));
    EXPECT_EQ(PMR_OK, setNumbers(material, "diffuse", {0.3, 0, 0.25}));
    EXPECT_EQ(PMR_OK, setText(material, "glossy", "0 0.1 0"));
    EXPECT_EQ(PMR_OK, setNumbers(material, "glossyExponent", {20}));
    EXPECT_EQ(PMR_OK, setNumbers(material, "transparency", {0.2}));
    EXPECT_EQ(PMR_OK, setNumbers(material, "emission", {0.7, 0, 0}));
    EXPECT_EQ(PMR_OK, setTexture(material, "diffuseTexture"));
    EXPECT_EQ(PMR_OK, setText(material, "name", "paint"));
    fill(PMR_LIGHT_POINT);
    const Result found = render();
    EXPECT_EQ(expected.identity, found.identity);
    expectSame(expected.pixels, found.pixels);
}

TEST_F(Described, SceneByNameEqualsByStruct) {
    const double turned[12] = {1, 0, 0, 0, 0, 0, -1, 0, 0, 1, 0, 3};
    const double camera[12] = {1, 0, 0, 0.5, 0, 1, 0, 0, 0, 0, 1, 5};
    PmrMaterialDesc grey = PMR_INIT(PmrMaterialDesc);
    for (float& value : grey.diffuse) value = 0.5f;
    makeScene(grey);
    PmrInstanceDesc instance = PMR_INIT(PmrInstanceDesc);
    instance.transforms = turned;
    instance.transformCount = 1;
    instance.hiddenFrom = PMR_HIDDEN_FROM_SHADOW;
    addInstance(instance);
    PmrLightDesc spot = PMR_INIT(PmrLightDesc);
    spot.kind = PMR_LIGHT_SPOT;
    spot.transforms = turned;
    spot.transformCount = 1;
    spot.emission[1] = 3.3f;
    spot.coneAngle = 2.1f;
    spot.coneFalloff = 0.7f;
    EXPECT_EQ(PMR_OK, api().addLight(m_scene, &spot));
    PmrEnvironmentDesc sky = PMR_INIT(PmrEnvironmentDesc);
    for (float& value : sky.radiance) value = 0.1f;
    sky.texture = m_texture;
    sky.transforms = turned;
    sky.transformCount = 1;
    EXPECT_EQ(PMR_OK, api().setEnvironment(m_scene, &sky));
    PmrCameraDesc view = PMR_INIT(PmrCameraDesc);
    view.transforms = camera;
    view.transformCount = 1;
    view.fieldOfView = 0.6;
    view.pixelAspect = 1.5;
    addCamera(&view);
    const Result expected = render();

    makeScene(grey);
    fill(PMR_LIGHT_POINT);
    const std::vector<double> byName(turned, turned + 12);
    EXPECT_EQ(PMR_OK, setNumbers(PMR_OBJECT_INSTANCE, "transforms", byName)) << lastError();
    EXPECT_EQ(PMR_OK, setNumbers(PMR_OBJECT_INSTANCE, "hiddenFrom", {PMR_HIDDEN_FROM_SHADOW}));
    EXPECT_EQ(PMR_OK, setNumbers(PMR_OBJECT_LIGHT, "coneAngle", {2.1})) << lastError();
    EXPECT_EQ(PMR_OK, setNumbers(PMR_OBJECT_LIGHT, "coneFalloff", {0.7}));
    EXPECT_EQ(PMR_OK, setText(PMR_OBJECT_LIGHT, "kind", "spot"));
    EXPECT_EQ(PMR_OK, setText(PMR_OBJECT_LIGHT, "transforms", "1 0 0 0 0 0 -1 0 0 1 0 3"));
    EXPECT_EQ(PMR_OK, setNumbers(PMR_OBJECT_LIGHT, "emission", {0, 3.3, 0}));
    EXPECT_EQ(PMR_OK, setNumbers(PMR_OBJECT_ENVIRONMENT, "radiance", {0.1, 0.1, 0.1}));
    EXPECT_EQ(PMR_OK, setTexture(PMR_OBJECT_ENVIRONMENT, "texture"));
    EXPECT_EQ(PMR_OK, setNumbers(PMR_OBJECT_ENVIRONMENT, "transforms", byName));
    EXPECT_EQ(PMR_OK, setText(PMR_OBJECT_CAMERA, "transforms", "1 0 0 0.5 0 1 0 0 0 0 1 5"));
    EXPECT_EQ(PMR_OK, setNumbers(PMR_OBJECT_CAMERA, "fieldOfView", {0.6}));
    EXPECT_EQ(PMR_OK, setNumbers(PMR_OBJECT_CAMERA, "pixelAspect", {1.5}));
    const Result found = render();
    EXPECT_EQ(expected.identity, found.identity);
    expectSame(expected.pixels, found.pixels);
}

// Something within the range that no object here has.
PmrStatus change(const PmrParameterInfo& info,
                 const std::function<PmrStatus(const std::vector<double>&)>& set) {
    if (info.count == 12) return set({1, 0, 0, 1, 0, 0, -1, 2, 0, 1, 0, 3});
    if (info.type == PMR_PARAMETER_CHOICE || info.type == PMR_PARAMETER_INTEGER) return set({1});
    const double value = std::isinf(info.maximum) ? 0.75 : (info.minimum + info.maximum) / 2;
    return set(std::vector<double>(info.count, value));
}

TEST_F(Described, EachThatChangesPixelsChangesTheIdentity) {
    const std::vector<std::int32_t> objects = {PMR_OBJECT_MATERIAL, PMR_OBJECT_LIGHT,
                                               PMR_OBJECT_ENVIRONMENT, PMR_OBJECT_CAMERA,
                                               PMR_OBJECT_INSTANCE};
    const std::vector<std::int32_t> lightKinds = {PMR_LIGHT_POINT, PMR_LIGHT_SPOT,
                                                  PMR_LIGHT_DIRECTIONAL};
    std::vector<std::string> plain;
    for (const std::int32_t kind : lightKinds) {
        makeScene(PMR_INIT(PmrMaterialDesc));
        fill(kind);
        plain.push_back(render().identity);
    }
    for (const std::int32_t object : objects) {
        for (const PmrParameterInfo& info : parametersOf(object)) {
            SCOPED_TRACE(std::to_string(object) + " " + info.name);
            if (info.type == PMR_PARAMETER_OBJECTS || info.type == PMR_PARAMETER_TEXT) continue;
            bool changes = false;
            for (std::size_t i = 0; i < lightKinds.size(); ++i) {
                if (object != PMR_OBJECT_LIGHT && i > 0) continue;
                makeScene(PMR_INIT(PmrMaterialDesc));
                const bool isMaterial = object == PMR_OBJECT_MATERIAL;
                std::string before = plain[i];
                // The scale of heights counts where there are some.
                if (info.name == std::string("displacementScale")) {
                    ASSERT_EQ(PMR_OK, setTexture(object, "displacementTexture"));
                    fill(lightKinds[i]);
                    before = render().identity;
                    makeScene(PMR_INIT(PmrMaterialDesc));
                    ASSERT_EQ(PMR_OK, setTexture(object, "displacementTexture"));
                }
                if (!isMaterial) fill(lightKinds[i]);
                const PmrStatus status =
                    info.type == PMR_PARAMETER_TEXTURE
                        ? setTexture(object, info.name)
                        : change(info, [&](const std::vector<double>& numbers) {
                              return setNumbers(object, info.name, numbers);
                          });
                if (status == PMR_ERROR_UNSUPPORTED) continue;
                ASSERT_EQ(PMR_OK, status) << lastError();
                if (isMaterial) fill(lightKinds[i]);
                changes = changes || render().identity != before;
            }
            EXPECT_EQ(info.changesPixels != 0, changes);
        }
    }
}

TEST_F(Described, OutOfRangeIsRefusedWithTheRange) {
    for (const std::int32_t object : {PMR_OBJECT_MATERIAL, PMR_OBJECT_LIGHT, PMR_OBJECT_ENVIRONMENT,
                                      PMR_OBJECT_CAMERA, PMR_OBJECT_INSTANCE}) {
        for (const PmrParameterInfo& info : parametersOf(object)) {
            SCOPED_TRACE(std::to_string(object) + " " + info.name);
            makeScene(PMR_INIT(PmrMaterialDesc));
            if (object != PMR_OBJECT_MATERIAL) fill(PMR_LIGHT_SPOT);
            if (info.type > PMR_PARAMETER_CHOICE) {
                if (info.type != PMR_PARAMETER_TEXT) {
                    EXPECT_EQ(PMR_ERROR_ARGUMENT, setText(object, info.name, "1"));
                }
                EXPECT_EQ(PMR_ERROR_ARGUMENT, setNumbers(object, info.name, {1}));
                continue;
            }
            const auto refused = [&](double value) {
                EXPECT_EQ(PMR_ERROR_ARGUMENT,
                          setNumbers(object, info.name, std::vector<double>(info.count, value)))
                    << value;
                EXPECT_NE(std::string::npos, lastError().find(info.name)) << lastError();
                EXPECT_NE(std::string::npos, lastError().find("it must be")) << lastError();
            };
            refused(std::nan(""));
            refused(HUGE_VAL);
            if (!std::isinf(info.minimum)) refused(info.minimum - 1);
            if (!std::isinf(info.maximum)) refused(info.maximum + 1);
            if (info.excludesMaximum != 0) refused(info.maximum);
            EXPECT_EQ(PMR_ERROR_ARGUMENT,
                      setNumbers(object, info.name, std::vector<double>(info.count + 1, 0.5)));
            EXPECT_EQ(PMR_ERROR_ARGUMENT, setText(object, info.name, "much"));
        }
    }
}

TEST_F(Described, WhatDoesNotFitTogetherIsRefused) {
    fill(PMR_LIGHT_SPOT);
    EXPECT_EQ(PMR_OK, setNumbers(PMR_OBJECT_LIGHT, "coneAngle", {1}));
    EXPECT_EQ(PMR_ERROR_ARGUMENT, setNumbers(PMR_OBJECT_LIGHT, "coneFalloff", {1.5}));
    EXPECT_NE(std::string::npos, lastError().find("coneAngle")) << lastError();
    EXPECT_EQ(PMR_ERROR_ARGUMENT,
              setText(PMR_OBJECT_LIGHT, "transforms", "2 0 0 0 0 1 0 0 0 0 1 0"));
    EXPECT_EQ(PMR_ERROR_ARGUMENT,
              setText(PMR_OBJECT_INSTANCE, "transforms", "0 0 0 0 0 1 0 0 0 0 1 0"));
    EXPECT_EQ(PMR_ERROR_UNSUPPORTED, setText(PMR_OBJECT_CAMERA, "kind", "panorama"));
    EXPECT_EQ(PMR_ERROR_UNSUPPORTED, setNumbers(PMR_OBJECT_CAMERA, "lensRadius", {0.1}));
    render();
}

TEST_F(Described, UnknownNamesAreRefusedWithThoseThatThereAre) {
    EXPECT_EQ(PMR_ERROR_NAME, setNumbers(PMR_OBJECT_MATERIAL, "shine", {1}));
    EXPECT_NE(std::string::npos, lastError().find("'shine'")) << lastError();
    EXPECT_NE(std::string::npos, lastError().find("diffuse, glossy")) << lastError();
    fill(PMR_LIGHT_POINT);
    EXPECT_EQ(PMR_ERROR_NAME, setNumbers(PMR_OBJECT_LIGHT, "watts", {1}));
    EXPECT_NE(std::string::npos, lastError().find("emission, coneAngle")) << lastError();
}

TEST_F(Described, ObjectsMustBeThereAndOpen) {
    EXPECT_EQ(PMR_ERROR_STATE, setNumbers(PMR_OBJECT_CAMERA, "fieldOfView", {1}));
    EXPECT_EQ(PMR_ERROR_STATE, setNumbers(PMR_OBJECT_ENVIRONMENT, "radiance", {1, 1, 1}));
    EXPECT_EQ(PMR_ERROR_ARGUMENT, setNumbers(PMR_OBJECT_LIGHT, "emission", {1, 1, 1}));
    EXPECT_NE(std::string::npos, lastError().find("index is 0")) << lastError();
    EXPECT_EQ(PMR_ERROR_ARGUMENT, setNumbers(PMR_OBJECT_SPHERE, "radius", {1}));
    EXPECT_EQ(PMR_ERROR_ARGUMENT, setNumbers(99, "radius", {1}));
    EXPECT_EQ(PMR_OK, setNumbers(PMR_OBJECT_MATERIAL, "diffuse", {1, 1, 1}));
    fill(PMR_LIGHT_POINT);
    EXPECT_EQ(PMR_ERROR_STATE, setNumbers(PMR_OBJECT_MATERIAL, "diffuse", {0, 0, 0}))
        << "a scene uses it";
    PmrParameterDesc both = parameter(PMR_OBJECT_CAMERA, "fieldOfView");
    both.material = m_material;
    both.text = "1";
    EXPECT_EQ(PMR_ERROR_ARGUMENT, api().setParameter(&both));
    EXPECT_EQ(PMR_ERROR_ARGUMENT, api().setParameter(nullptr));
    render();
    EXPECT_EQ(PMR_ERROR_STATE, setNumbers(PMR_OBJECT_CAMERA, "fieldOfView", {1}));
    PmrParameterDesc gone = parameter(PMR_OBJECT_MATERIAL, "diffuse");
    gone.material = reinterpret_cast<PmrMaterial>(0x1230);
    EXPECT_EQ(PMR_ERROR_HANDLE, api().setParameter(&gone));
}

// A sphere by its struct and by named parameters is the same sphere.
TEST_F(Described, ShapesAreMadeByName) {
    const double centre[3] = {0, 0.25, 0}, radius = 0.5;
    PmrSphereDesc preset = PMR_INIT(PmrSphereDesc);
    std::copy(std::begin(centre), std::end(centre), preset.centre);
    preset.radius = radius;
    PmrParameterDesc place = PMR_INIT(PmrParameterDesc), size = place;
    place.object = size.object = PMR_OBJECT_SPHERE;
    place.name = "centre";
    place.numbers = centre;
    place.numberCount = 3;
    size.name = "radius";
    size.text = "0.5";
    const PmrParameterDesc* const given[] = {&place, &size};

    const auto renderOf = [&](const std::function<PmrStatus(PmrMesh*)>& make) {
        PmrInstanceDesc instance = PMR_INIT(PmrInstanceDesc);
        makeScene(PMR_INIT(PmrMaterialDesc));
        EXPECT_EQ(PMR_OK, make(&instance.mesh)) << lastError();
        addInstance(instance);
        addCamera();
        return render();
    };
    const Result byStruct =
        renderOf([&](PmrMesh* mesh) { return api().createSphere(m_context, &preset, mesh); });
    const Result byName = renderOf([&](PmrMesh* mesh) {
        return api().createShape(m_context, PMR_OBJECT_SPHERE, given, 2, mesh);
    });
    EXPECT_EQ(byStruct.identity, byName.identity);
    EXPECT_EQ(byStruct.pixels, byName.pixels);
}

TEST_F(Described, ShapesAreRefusedWithWhatIsAllowed) {
    PmrMesh shape = nullptr;
    PmrParameterDesc size = PMR_INIT(PmrParameterDesc);
    size.object = PMR_OBJECT_SPHERE;
    size.name = "radius";
    size.text = "0";
    const auto make = [&](std::int32_t object, std::uint32_t count) {
        const PmrParameterDesc* const given[] = {&size};
        return api().createShape(m_context, object, given, count, &shape);
    };
    EXPECT_EQ(PMR_ERROR_ARGUMENT, make(PMR_OBJECT_SPHERE, 1)) << "a radius of 0";
    EXPECT_NE(std::string::npos, lastError().find("sphere: radius is 0")) << lastError();
    EXPECT_EQ(PMR_ERROR_ARGUMENT, make(PMR_OBJECT_SPHERE, 0)) << "its default is none";
    EXPECT_EQ(PMR_ERROR_ARGUMENT, make(PMR_OBJECT_CAMERA, 0));
    EXPECT_NE(std::string::npos, lastError().find("must be 5 to")) << lastError();
    EXPECT_EQ(PMR_ERROR_ARGUMENT, make(99, 0));
    size.text = "1";
    size.name = "height";
    EXPECT_EQ(PMR_ERROR_NAME, make(PMR_OBJECT_SPHERE, 1));
    size.name = "radius";
    size.object = PMR_OBJECT_CAMERA;
    EXPECT_EQ(PMR_ERROR_ARGUMENT, make(PMR_OBJECT_SPHERE, 1)) << "of another object";
    size.object = PMR_OBJECT_SPHERE;
    EXPECT_EQ(PMR_ERROR_ARGUMENT,
              api().createShape(m_context, PMR_OBJECT_SPHERE, nullptr, 1, &shape));
    EXPECT_EQ(nullptr, shape);
    EXPECT_EQ(PMR_OK, make(PMR_OBJECT_SPHERE, 1)) << lastError();
    EXPECT_EQ(PMR_OK, api().releaseMesh(shape));
}

TEST(Parameters, AreListed) {
    EXPECT_STREQ("sphere", api().objectName(PMR_OBJECT_SPHERE));
    EXPECT_EQ(nullptr, api().objectName(-1));
    EXPECT_EQ(nullptr, api().objectName(99));
    for (std::int32_t object = 0; api().objectName(object) != nullptr; ++object) {
        EXPECT_GT(api().parameterCount(object), 0u);
        for (const PmrParameterInfo& info : parametersOf(object)) {
            EXPECT_NE(0, *info.name);
            EXPECT_NE(0, *info.help);
        }
        PmrParameterInfo info = PMR_INIT(PmrParameterInfo);
        EXPECT_EQ(PMR_ERROR_ARGUMENT,
                  api().parameterInfo(object, api().parameterCount(object), &info));
    }
    EXPECT_EQ(0u, api().parameterCount(99));
    EXPECT_EQ(0u, api().parameterCount(-1));
}

}  // namespace

}  // namespace pm::test
