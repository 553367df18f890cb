// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// What a sidecar says, what it adds to a scene, and what is refused of it.
#include "host_shim/formats/sidecar/sidecar.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>

#include "host_shim/look/framing.h"
#include "tests/ingest/heard.h"

namespace pm::host::test {
namespace {

using Place = std::array<double, 3>;

constexpr const char* kSchema = R"({"schema": "pm-sidecar/1", )";

Sidecar readAll(const std::string& text) {
    SceneFiles files(".", {});
    return readSidecar(text, "s.pm.json", files);
}

Sidecar read(const std::string& rest) {
    return readAll(kSchema + rest + "}");
}

// The refusal without the code and file in front.
std::string refusalOf(const std::string& rest) {
    const std::string error = errorOf([&] { read(rest); });
    constexpr std::string_view kFront = "3 s.pm.json: ";
    return error.starts_with(kFront) ? error.substr(kFront.size()) : "other: " + error;
}

// Two groups, of which the second has two materials; both about x = 0.5.
SceneData scene() {
    Heard heard;
    return readObj(
        "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\ng a\nusemtl m\nf 1 2 3 4\ng b\nusemtl m\nf 1 2 3\n"
        "usemtl n\nf 1 3 4\n",
        "s.obj", ".", heard.sink);
}

SceneData sceneWith(const std::string& rest) {
    SceneData data = scene();
    addSidecar(read(rest), data);
    return data;
}

TEST(Sidecar, WithoutAnythingChangesNothing) {
    const SceneData data = sceneWith(R"("instances": [])");
    EXPECT_EQ(data.instances.size(), 2u);
    EXPECT_EQ(data.bounds.high[0], scene().bounds.high[0]);
    EXPECT_FALSE(data.environment);
    EXPECT_EQ(data.sidecar, "s.pm.json");
    EXPECT_EQ(data.files, std::vector<std::string>{"s.pm.json"});
}

TEST(Sidecar, PlacesGroupsByInstancesAlone) {
    const SceneData data = sceneWith(
        R"("instances": [{"of": "b", "translate": [10, 0, 0], "hiddenFrom": ["camera", "shadow"]},
                         {"of": "b", "name": "second", "translate": [0, 0, 5],
                          "rotate": [0, 90, 0], "scale": [2, 1, 1]}])");
    ASSERT_EQ(data.instances.size(), 3u);
    EXPECT_EQ(data.instances[0].name, "a");
    EXPECT_FALSE(data.instances[0].transform);
    EXPECT_EQ(data.instances[1].name, "b");
    EXPECT_EQ(data.instances[1].hiddenFrom, kHiddenFromCamera + kHiddenFromShadow);
    EXPECT_EQ(data.instances[2].name, "second");
    // Scaled to (2,1,0), then turned about y: x goes to -z.
    EXPECT_EQ(transformed(*data.instances[2].transform, Place{1, 1, 0}), (Place{0, 1, 3}));
    EXPECT_EQ(data.bounds.low, (Place{0, 0, 0}));
    EXPECT_EQ(data.bounds.high, (Place{11, 1, 5}));
}

TEST(Sidecar, WithoutOfPlacesTheWholeFile) {
    const SceneData data =
        sceneWith(R"("instances": [{"matrix": [1, 0, 0, 3, 0, 1, 0, 0, 0, 0, 1, 0]}, {}])");
    ASSERT_EQ(data.instances.size(), 4u);
    EXPECT_EQ((*data.instances[0].transform)[3], 3);
    EXPECT_EQ(data.instances[2].transform, std::nullopt);
    EXPECT_EQ(data.bounds.high[0], 4);
}

TEST(Sidecar, PutsMaterialsInPlaceOfOthers) {
    const SceneData data = sceneWith(
        R"("instances": [{"of": "b", "materials": {"m": "n"}}, {"of": "b", "materials": "m"}],
           "spheres": [{"radius": 2, "centre": [0, 0, 9], "material": "n"}])");
    ASSERT_EQ(data.instances.size(), 4u);
    EXPECT_EQ(data.materialsOf(data.instances[1]), (std::vector<std::uint32_t>{1, 1}));
    EXPECT_EQ(data.materialsOf(data.instances[2]), (std::vector<std::uint32_t>{0, 0}));
    EXPECT_EQ(data.materialsOf(data.instances[3]), std::vector<std::uint32_t>{1});
    EXPECT_EQ(data.bounds.high[2], 11);
    EXPECT_EQ(data.bounds.low[0], -2);
}

TEST(Sidecar, DescribesLights) {
    const Sidecar sidecar = read(
        R"("lights": [{"type": "point", "position": [1, 2, 3], "intensity": 5},
            {"type": "spot", "name": "lamp", "position": [0, 2, 0], "lookAt": [0, 0, 0],
             "intensity": [1, 2, 3], "angle": 180, "falloff": 90, "colourSpace": "rendering"},
            {"type": "directional", "direction": [0, 0, -2], "irradiance": 4, "angle": 90}],
           "environment": {"radiance": [1, 2, 3], "rotate": [0, 180, 0]})");
    ASSERT_EQ(sidecar.lights.size(), 3u);
    const LightData& point = sidecar.lights[0];
    EXPECT_EQ(point.kind, LightData::Kind::kPoint);
    EXPECT_EQ(point.name, "lights[0]");
    EXPECT_EQ(transformed(point.transform, Place{0, 0, 0}), (Place{1, 2, 3}));
    EXPECT_EQ(point.emission, (std::array<float, 3>{5, 5, 5}));
    const LightData& spot = sidecar.lights[1];
    EXPECT_EQ(spot.name, "lamp");
    EXPECT_TRUE(spot.isInRenderingSpace);
    EXPECT_EQ(spot.coneAngle, std::numbers::pi_v<float>);
    EXPECT_FLOAT_EQ(spot.coneFalloff, std::numbers::pi_v<float> / 2);
    // Shines along -z of its transform, downwards.
    EXPECT_EQ(spot.transform[6], 1);
    const LightData& sun = sidecar.lights[2];
    EXPECT_EQ(sun.kind, LightData::Kind::kDirectional);
    EXPECT_EQ(sun.transform[10], 1);
    EXPECT_FLOAT_EQ(sun.angularRadius, std::numbers::pi_v<float> / 2);
    ASSERT_TRUE(sidecar.environment);
    EXPECT_EQ(sidecar.environment->radiance, (std::array<float, 3>{1, 2, 3}));
    EXPECT_EQ((*sidecar.environment->transform)[0], -1);
}

TEST(Sidecar, CamerasAreWhatTheOptionsLeave) {
    const Sidecar sidecar = read(
        R"("cameras": [{"name": "a", "position": [0, 0, 9], "fieldOfView": 50, "pixelAspect": 2},
                       {"name": "m", "matrix": [0, 0, 1, 7, 0, 1, 0, 1, -1, 0, 0, 0]}])");
    const Bounds bounds{{0, 0, 0}, {1, 1, 1}};
    const CameraPose a = poseOf(sidecar.cameras.at(0), {}, bounds, 1);
    EXPECT_EQ(a.eye, (Place{0, 0, 9}));
    EXPECT_EQ(a.lookAt, bounds.centre());
    EXPECT_EQ(a.verticalFovDegrees, 50);
    EXPECT_EQ(a.lens.pixelAspect, 2);
    CameraOptions options;
    options.eye = {3, 3, 3};
    options.verticalFovDegrees = 20;
    const CameraPose moved = poseOf(sidecar.cameras[0], options, bounds, 1);
    EXPECT_EQ(moved.eye, *options.eye);
    EXPECT_EQ(moved.verticalFovDegrees, 20);
    const CameraPose m = poseOf(sidecar.cameras.at(1), {}, bounds, 1);
    EXPECT_EQ(m.transform, *sidecar.cameras[1].transform);
    EXPECT_EQ(m.lookAt, (Place{6, 1, 0}));
    EXPECT_EQ(m.verticalFovDegrees, 40);
}

TEST(Sidecar, RefusesWithPlaceValueAndWhatIsAllowed) {
    const std::string spot =
        R"({"type": "spot", "position": [0, 1, 0], "lookAt": [0, 0, 0], "intensity": 1)";
    const std::vector<std::pair<std::string, std::string>> cases{
        {R"("lights": [)" + spot + R"(, "angle": 9}, )" + spot + R"(, "angle": -1}])",
         "lights[1].angle is -1; it must be in (0, 180] degrees"},
        {R"("lights": [)" + spot + R"(, "angle": 9, "falloff": 10}])",
         "lights[0].falloff is 10; it must be in [0, 9] degrees"},
        {R"("lights": [)" + spot + R"(, "angle": 9, "cone": 10}])",
         "lights[0] has a 'cone'; allowed are type, name, position, lookAt, matrix, intensity, "
         "colourSpace, angle, falloff"},
        {R"("lights": [{"type": "area"}])",
         "lights[0].type is 'area'; it must be one of point, spot, directional"},
        {R"("lights": [{}])", "lights[0] has no 'type', which it must have"},
        {R"("lights": [{"type": "point", "position": [0, 1], "intensity": 1}])",
         "lights[0].position is a list of 2; it must be a list of 3 numbers"},
        {R"("lights": [{"type": "point", "position": [0, 1, "x"], "intensity": 1}])",
         "lights[0].position[2] is 'x'; it must be a number"},
        {R"("lights": [{"type": "point", "position": [0, 1, 2], "intensity": [1, -1, 1]}])",
         "lights[0].intensity[1] is -1; it must be in [0, 3.40282e+38]"},
        {R"("lights": [{"type": "directional", "direction": [0, 0, 0], "irradiance": 1}])",
         "lights[0].direction has no direction; it must not be 0,0,0"},
        {R"("lights": 3)", "lights is 3; it must be a list"},
        {R"("lamps": [])",
         "it has a 'lamps'; allowed are $schema, schema, instances, spheres, materials, lights, "
         "environment, "
         "sky, cameras"},
        {R"("sky": {"azimuth": 0, "elevation": 0})",
         "sky.elevation is 0; it must be in (0, 90] degrees"},
        {R"("sky": {"elevation": 30})", "sky has no 'azimuth', which it must have"},
        {R"("sky": {"azimuth": 0, "elevation": 9}, "environment": {"radiance": 1})",
         "it has environment and sky; it is one of them"},
        {R"("instances": [{"matrix": [1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0]}])",
         "instances[0].matrix has no inverse; it must not flatten space"},
        {R"("instances": [{"scale": [1, 0, 1]}])",
         "instances[0].scale is 0; it must not flatten space"},
        {R"("instances": [{"scale": 2, "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0]}])",
         "instances[0] has a matrix and one of translate, rotate and scale; it is either"},
        {R"("instances": [{"hiddenFrom": ["shade"]}])",
         "instances[0].hiddenFrom[0] is 'shade'; it must be one of camera, shadow, reflection"},
        {R"("instances": [{"materials": 1}])",
         "instances[0].materials must be the name of a material, or an object with names in place "
         "of names"},
        {R"("spheres": [{"radius": 0, "material": "m"}])",
         "spheres[0].radius is 0; it must be in (0, 1e+30] scene units"},
        {R"("environment": {})", "environment has no 'radiance', which it must have"},
        {R"("environment": {"texture": "no.exr"})", "environment.texture: 'no.exr' is no file"},
        {R"("cameras": [{"position": [0, 0, 1], "lookAt": [0, 0, 1]}])",
         "cameras[0].lookAt is where it stands; it must be another point"},
        {R"("cameras": [{"position": [0, 0, 1], "fieldOfView": 180}])",
         "cameras[0].fieldOfView is 180; it must be in (0, 180) degrees"},
        {R"("cameras": [{"matrix": [2, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0]}])",
         "cameras[0].matrix stretches or shears; it must be a rotation and a translation"},
        {R"("cameras": [{"name": "a", "position": [0, 0, 1]}, {"name": "a", "position": [1, 0, 1]}])",
         "cameras[1] is named 'a' like one before it"},
        {R"("cameras": [], "cameras": [])", "'cameras' is there twice"},
        {R"("cameras": [NaN])", "no JSON: "},
        {R"("instances": [{"translate": [1e999, 0, 0]}])", "no JSON: number overflow"},
        {R"("lights": [[[[[[[[[[[[[[[[[]]]]]]]]]]]]]]]]])",
         "lists and objects stand in each other more than 16 deep"},
    };
    for (const auto& [rest, text] : cases) {
        const std::string refused = refusalOf(rest);
        EXPECT_TRUE(refused.starts_with(text)) << rest << "\n  " << refused;
    }
    EXPECT_EQ(errorOf([] { readAll("{}"); }),
              "3 s.pm.json: it has no 'schema', which it must have");
    EXPECT_EQ(errorOf([] { readAll(R"({"schema": "pm-sidecar/2"})"); }),
              "3 s.pm.json: schema is 'pm-sidecar/2'; it must be one of pm-sidecar/1");
    EXPECT_TRUE(errorOf([] { readAll(""); }).starts_with("3 s.pm.json: no JSON: "));
    EXPECT_TRUE(errorOf([] { readAll("[1]"); }).starts_with("3 s.pm.json: it is a list of 1"));
}

TEST(Sidecar, RefusesWhatTheSceneHasNot) {
    const auto refused = [](const std::string& rest) { return errorOf([&] { sceneWith(rest); }); };
    EXPECT_EQ(refused(R"("instances": [{}, {"of": "c"}])"),
              "3 s.pm.json: instances[1].of is 'c', and no group of the scene; they are 'a', 'b'");
    EXPECT_EQ(refused(R"("instances": [{"of": "a", "materials": {"n": "m"}}])"),
              "3 s.pm.json: instances[0].materials names 'n', which is on no face of it; there are "
              "'m'");
    EXPECT_TRUE(refused(R"("spheres": [{"radius": 1, "material": "gold"}])")
                    .starts_with("3 s.pm.json: spheres[0].material is 'gold', which no material "
                                 "library of the scene has"));
}

// A material that no face uses is read where the sidecar wants it.
TEST(Sidecar, TakesMaterialsThatNoFaceUses) {
    namespace fs = std::filesystem;
    std::string name = ::testing::TempDir() + "pm_sidecar.XXXXXX";
    ASSERT_NE(mkdtemp(name.data()), nullptr);
    const fs::path folder = name;
    std::ofstream(folder / "s.mtl") << "newmtl gold\nKd 0.5 0.25 0\nnewmtl m\nKd 0 0 1\n";
    ReadRules rules;
    rules.materials = {"gold", "m", "absent"};
    Heard heard;
    const SceneData data = readObj("mtllib s.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n",
                                   "s.obj", folder, heard.sink, {}, {}, rules);
    fs::remove_all(folder);
    ASSERT_EQ(data.materials.size(), 3u);
    EXPECT_EQ(data.materials[1].name, "gold");
    EXPECT_EQ(data.materials[1].diffuse[1], 0.25f);
    EXPECT_EQ(data.materials[2].name, "default");
    EXPECT_TRUE(heard.list.empty());
}

TEST(Sidecar, MaterialsHaveParametersByName) {
    const SceneData data = sceneWith(
        R"("materials": {"n": {"attenuationColour": [0.1, 0.2, 0.3], "priority": 2,
                               "kind": "dielectric"}})");
    ASSERT_EQ(data.materials[1].name, "n");
    EXPECT_TRUE(data.materials[0].byName.empty());
    const std::vector<NamedValue>& values = data.materials[1].byName;
    ASSERT_EQ(values.size(), 3u);
    EXPECT_EQ(values[0].name, "attenuationColour");
    EXPECT_EQ(values[0].numbers, (std::vector<double>{0.1, 0.2, 0.3}));
    EXPECT_EQ(values[1].numbers, std::vector<double>{2});
    EXPECT_EQ(values[2].text, "dielectric");
    EXPECT_EQ(values[1].place, "s.pm.json: materials['n']['priority']");
}

TEST(Sidecar, WrittenGuessesAreReadAgain) {
    SidecarGuess guess;
    guess.camera.emplace();
    guess.camera->name = "found";
    guess.camera->eye = {0.1, 1.0 / 3, 1e-300};
    guess.camera->lookAt = {-5, 0, 1e17};
    guess.camera->up = {0, 0, 1};
    guess.camera->verticalFovDegrees = 40;
    guess.light.emplace();
    guess.light->name = "camera light";
    guess.light->transform[3] = 0.1;
    guess.light->emission = {0.1f, 1.0f / 3, 1e-30f};
    guess.light->isInRenderingSpace = true;
    const std::string text = withGuess("", guess);
    const Sidecar sidecar = readAll(text);
    ASSERT_EQ(sidecar.cameras.size(), 1u);
    EXPECT_EQ(sidecar.cameras[0].eye, guess.camera->eye);
    EXPECT_EQ(sidecar.cameras[0].lookAt, guess.camera->lookAt);
    EXPECT_EQ(sidecar.cameras[0].up, guess.camera->up);
    EXPECT_EQ(sidecar.cameras[0].verticalFovDegrees, 40);
    ASSERT_EQ(sidecar.lights.size(), 1u);
    EXPECT_EQ(sidecar.lights[0].emission, guess.light->emission);
    EXPECT_EQ(sidecar.lights[0].transform, guess.light->transform);
    EXPECT_EQ(sidecar.lights[0].name, guess.light->name);
    EXPECT_TRUE(sidecar.lights[0].isInRenderingSpace);
    // What stands in a file stays there.
    const std::string more = withGuess(
        R"({"schema": "pm-sidecar/1", "cameras": [{"position": [1, 2, 3]}], "spheres": []})",
        guess);
    EXPECT_EQ(readAll(more).cameras.size(), 1u);
    EXPECT_EQ(readAll(more).cameras[0].eye, (Place{1, 2, 3}));
    EXPECT_EQ(readAll(more).lights.size(), 1u);
}

}  // namespace
}  // namespace pm::host::test
