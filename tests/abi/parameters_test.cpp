// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Parameters by name: the same scene as by structs, in bits and in identity; and each that changes
// pixels changes the identity.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "tests/abi/described.h"

namespace pm::test {

namespace {

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
