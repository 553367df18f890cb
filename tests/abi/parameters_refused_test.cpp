// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Parameters by name that are not allowed are refused with the range or the names.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "tests/abi/described.h"

namespace pm::test {

namespace {

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

TEST_F(Described, PartsOfMixturesAreNamed) {
    PmrMaterialDesc plain = PMR_INIT(PmrMaterialDesc), mixed = plain;
    plain.name = "plain";
    plain.diffuse[0] = 0.5f;
    mixed.name = "mixed";
    mixed.kind = PMR_MATERIAL_MIXTURE;
    PmrMaterial part = nullptr;
    ASSERT_EQ(PMR_OK, api().createMaterial(m_context, &plain, &part));
    makeScene(mixed);
    EXPECT_EQ(PMR_ERROR_NAME, setText(PMR_OBJECT_MATERIAL, "first", "none"));
    EXPECT_EQ("material 'mixed': first is 'none', and no material of that name has been made",
              lastError());
    EXPECT_EQ(PMR_ERROR_ARGUMENT, setText(PMR_OBJECT_MATERIAL, "first", "mixed"));
    EXPECT_NE(std::string::npos, lastError().find("a part of itself")) << lastError();
    ASSERT_EQ(PMR_OK, setText(PMR_OBJECT_MATERIAL, "first", "plain"));
    // It needs both, and holds them.
    PmrSphereDesc sphere = PMR_INIT(PmrSphereDesc);
    sphere.radius = 1;
    PmrInstanceDesc instance = PMR_INIT(PmrInstanceDesc);
    ASSERT_EQ(PMR_OK, api().createSphere(m_context, &sphere, &instance.mesh));
    instance.materials = &m_material;
    instance.materialCount = 1;
    EXPECT_EQ(PMR_ERROR_ARGUMENT, api().addInstance(m_scene, &instance));
    EXPECT_EQ("material 'mixed' is a mixture; its first and second have to be set", lastError());
    EXPECT_EQ(PMR_OK, api().releaseMesh(instance.mesh));
    makeScene(mixed);
    ASSERT_EQ(PMR_OK, setText(PMR_OBJECT_MATERIAL, "first", "plain"));
    ASSERT_EQ(PMR_OK, setText(PMR_OBJECT_MATERIAL, "second", "plain"));
    EXPECT_EQ(PMR_OK, api().releaseMaterial(part));
    fill(PMR_LIGHT_SPOT);
    render();
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

}  // namespace

}  // namespace pm::test
