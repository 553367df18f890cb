// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// What statements of POV-Ray's become: spaces, meshes and cameras.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "host_shim/formats/pov/animation.h"
#include "host_shim/formats/pov/objects/camera_of.h"
#include "host_shim/formats/pov/objects/scene_of.h"
#include "tests/pov/evaluated.h"

namespace pm::host::pov::test {
namespace {

SceneOf made(const std::string& text) {
    return sceneOf(Scene().read(text), {640, 480});
}

TEST(PovObjects, SpacesAreMirroredOnce) {
    const SceneOf scene = made("union { sphere { <1, 2, 3>, 0.5 } translate <0, 0, 1> scale 2 }");
    ASSERT_EQ(scene.data.spheres.size(), 1u);
    const auto centre =
        pm::host::transformed(*scene.data.instances[0].transform, scene.data.spheres[0].centre);
    EXPECT_EQ(centre, (std::array<double, 3>{2, 4, -8}));
    EXPECT_EQ(scene.data.bounds.low, (std::array<double, 3>{1, 3, -9}));
}

// Of a triangle that POV-Ray's camera sees counter-clockwise ours sees the same.
TEST(PovObjects, WindingTurnsWithTheMirror) {
    const SceneOf scene = made("triangle { <0, 0, 0>, <1, 0, 0>, <0, 1, 0> }");
    ASSERT_EQ(scene.data.meshes.size(), 1u);
    EXPECT_EQ(scene.data.meshes[0].indices, (std::vector<std::uint32_t>{0, 2, 1}));
}

TEST(PovObjects, Mesh2HasItsNormals) {
    const SceneOf scene = made(
        "mesh2 { vertex_vectors { 4, <0,0,0>, <1,0,0>, <1,1,0>, <0,1,0> } "
        "normal_vectors { 1, <0, 0, -1> } face_indices { 2, <0,1,2>, <0,2,3> } "
        "normal_indices { 2, <0,0,0>, <0,0,0> } }");
    ASSERT_EQ(scene.data.meshes.size(), 1u);
    EXPECT_EQ(scene.data.meshes[0].faceSizes.size(), 2u);
    EXPECT_EQ(scene.data.meshes[0].normals, (std::vector<float>{0, 0, 1}));
    EXPECT_EQ(scene.data.meshes[0].normalIndices, std::vector<std::uint32_t>(6, 0));
}

TEST(PovObjects, WhatWaitsIsNamedAndCounted) {
    const SceneOf scene = made("box { 0, 1 } box { 1, 2 } sphere { 0, 1 } light_source { 0, 1 }");
    EXPECT_EQ(scene.leftOut.at("box: waits for shapes").count, 2u);
    EXPECT_EQ(scene.leftOut.at("light_source: waits for looks").count, 1u);
    EXPECT_EQ(scene.objects, 3u);
}

TEST(PovObjects, IniSaysTheClock) {
    const PovIni ini = readPovIni(
        "; frames\nInitial_Frame = 1\nfinal_frame=5 ; five\nFinal_Clock=2\nDeclare=A=3\n+kfi0\n");
    EXPECT_EQ(ini.declared.at("A"), "3");
    EXPECT_EQ(ini.firstFrame, 0);
    EXPECT_DOUBLE_EQ(clockOf(ini, 5).at("clock"), 2);
    EXPECT_DOUBLE_EQ(clockOf(ini, {}).at("frame_number"), 0);
    EXPECT_DOUBLE_EQ(clockOf(ini, 1).at("clock"), 0.4);
    EXPECT_DOUBLE_EQ(clockOf({}, {}).at("clock_on"), 0);
    EXPECT_DOUBLE_EQ(clockOf(readPovIni("Clock=.25"), {}).at("clock"), 0.25);
}

TEST(PovObjects, CamerasWithoutVolumeAreLeftOut) {
    EXPECT_EQ(made("camera { direction x right x } sphere { 0, 1 }").data.cameras.size(), 0u);
    const SceneOf wide = made("camera { fisheye angle 360 look_at z } sphere { 0, 1 }");
    EXPECT_NEAR(wide.data.cameras.at(0).verticalFovDegrees.value(),
                2 * std::atan(0.5) * 180 / std::numbers::pi, 1e-12);
}

TEST(PovObjects, CamerasAngleIsHorizontal) {
    const Evaluated scene =
        Scene().read("camera { location <0, 0, -5> look_at <0, 0, 10> right 2 * x up y angle 90 }");
    const PovCamera camera = povCameraOf(*scene.statements[0]);
    EXPECT_NEAR(camera.direction[2], 1, 1e-12);
    EXPECT_NEAR(camera.right[0], 2, 1e-12);
    EXPECT_NEAR(camera.aspect(), 2, 1e-12);
}

}  // namespace
}  // namespace pm::host::pov::test
