// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Pictures of scenes with a sidecar, against closed forms and against the same scenes made by other
// means.
#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "tests/scene/host_test.h"
#include "tests/scene/picture_measures.h"

namespace pm::host::test {
namespace {

constexpr const char* kGround =
    "mtllib s.mtl\nv -50 0 -50\nv 50 0 -50\nv 50 0 50\nv -50 0 50\ng ground\nusemtl half\nf 4 3 2 "
    "1\n";
constexpr const char* kMaterials =
    "newmtl half\nKd 0.5 0.5 0.5\nnewmtl red\nKd 0.5 0 0\nnewmtl lamp\nKd 0 0 0\nKe 3 3 3\n";
// Straight down on the origin from a height of 8, 2 pixels of which see next to nothing else.
const Arguments kDown{"--size", "2x2", "--fov", "1", "--eye", "0,8,0", "--look-at", "0,0,0"};
const Arguments kQuick{"--integrator", "path", "--passes", "1", "--aa", "2"};

class SidecarScene : public HostTest {
  protected:
    void scene(const std::string& obj, const std::string& sidecar) {
        write("s.mtl", kMaterials);
        write("s.obj", obj);
        if (!sidecar.empty()) write("s.pm.json", "{\"schema\": \"pm-sidecar/1\", " + sidecar + "}");
    }
    Picture picture(const Arguments& arguments) {
        return renderExr("s", Arguments{"s.obj"} + arguments);
    }
    // Of R, of what the camera sees at the origin of the ground.
    double atOrigin(const std::string& sidecar, const Arguments& more = {}) {
        scene(kGround, sidecar);
        return meansOf(picture(kDown + kQuick + more), "")[0];
    }
    void expectSame(const Picture& a, const Picture& b) {
        ASSERT_EQ(a.channels.size(), b.channels.size());
        ASSERT_FALSE(a.channels.empty());
        for (std::size_t i = 0; i < a.channels.size(); ++i)
            EXPECT_EQ(a.channels[i].values, b.channels[i].values) << a.channels[i].name;
    }
    static bool areAlike(const Picture& a, const Picture& b) {
        for (std::size_t i = 0; i < a.channels.size(); ++i)
            if (a.channels[i].values != b.channels.at(i).values) return false;
        return true;
    }
};

// A point light of I at height h lights the ground below by I / h^2, of which it reflects 1/2 by
// Lambert's law.
TEST_F(SidecarScene, LightsGiveWhatTheyAreToGive) {
    constexpr double kPi = std::numbers::pi;
    EXPECT_NEAR(atOrigin(R"("lights": [{"type": "point", "position": [0, 2, 0], "intensity": 8}])"),
                8.0 / 4 / 2 / kPi, 1e-3);
    const auto spot = [&](const char* lookAt) {
        return atOrigin(fmt::format(
            R"("lights": [{{"type": "spot", "position": [0, 2, 0], "lookAt": {}, "intensity": 8,
                            "angle": 30, "falloff": 5}}])",
            lookAt));
    };
    EXPECT_NEAR(spot("[0.5, 0, 0]"), 8.0 / 4 / 2 / kPi, 1e-3);
    EXPECT_EQ(spot("[4, 0, 0]"), 0.0) << "outside of the cone";
    EXPECT_NEAR(
        atOrigin(
            R"("lights": [{"type": "directional", "direction": [0, -1, 0], "irradiance": 3}])"),
        3.0 / 2 / kPi, 1e-3);
    EXPECT_NEAR(atOrigin(R"("environment": {"radiance": [1, 1, 1]})", {"--size", "24x24"}), 0.5,
                0.02);
}

// The left half of the picture is red, the right half green; a turn by 180 degrees swaps them.
TEST_F(SidecarScene, EnvironmentsHaveTextures) {
    DisplayPicture halves{64, 32, 3, {}};
    for (int i = 0; i < 64 * 32; ++i)
        for (int c = 0; c < 3; ++c)
            halves.values.push_back(c == (i % 64 < 32 ? 0 : 1) ? 1.0f : 0.0f);
    writeDisplayPicture(path("sky.png"), halves);
    const auto red = [&](const char* turn) {
        scene(kGround, fmt::format(R"("environment": {{"texture": "sky.png"{}}})", turn));
        // Upwards to the left: no ground.
        const Picture sky = picture(
            Arguments{"--size", "4x4", "--fov", "10", "--eye", "0,1,0", "--look-at", "-1,3,-0.5"} +
            kQuick);
        const Means means = meansOf(sky, "");
        EXPECT_NEAR(means[0] + means[1], 1.0, 0.05);
        return means[0];
    };
    EXPECT_GT(red(""), 0.95);
    EXPECT_LT(red(R"(, "rotate": [0, 180, 0])"), 0.05);
}

// A sphere that shines covers the disc of its outline.
TEST_F(SidecarScene, SpheresHaveMaterialsOfTheMtl) {
    scene(kGround, R"("instances": [{"translate": [0, -90, 0]}],
                      "spheres": [{"centre": [0, 1, 0], "radius": 0.5, "material": "lamp"}])");
    const Picture seen = picture(Arguments{"--size", "64x64", "--fov", "20", "--eye", "0,1,10",
                                           "--look-at", "0,1,0", "--aa", "4"} +
                                 Arguments{"--integrator", "path", "--passes", "1"});
    const double height = 2 * 10 * std::tan(10 * std::numbers::pi / 180);
    // Seen from 10 its outline is a little wider than it is.
    const double outline = 0.5 / std::sqrt(1 - 0.5 * 0.5 / 100);
    const double share = std::numbers::pi * outline * outline / (height * height);
    EXPECT_NEAR(meansOf(seen, "")[0], 3 * share, 0.02 * 3 * share);
}

// A tent in another place, by a transform and by its vertices.
TEST_F(SidecarScene, InstancesAreWhatTheirVerticesWouldBe) {
    const std::string light = R"("lights": [{"type": "point", "position": [2, 5, 3],
                                             "intensity": 60}])";
    const std::string ground(kGround);
    const auto tent = [](double x, double z, double s, const char* material) {
        return fmt::format(
            "v {} 0 {}\nv {} 0 {}\nv {} {} {}\ng tent\nusemtl {}\nf -3 -2 -1\nf -1 -2 -3\n", x - s,
            z, x + s, z, x, 2 * s, z, material);
    };
    const Arguments view{"--size",       "48x36", "--eye",    "0,4,9", "--look-at", "0,0,0",
                         "--integrator", "path",  "--passes", "2",     "--aa",      "3"};
    scene(ground + tent(1.5, -1, 2, "red") + tent(-1, 1, 1, "half"), light);
    const Picture byVertices = picture(view);
    scene(ground + tent(0, 0, 1, "half"), light + R"(, "instances": [
              {"of": "tent", "translate": [1.5, 0, -1], "scale": 2, "materials": {"half": "red"}},
              {"of": "tent", "matrix": [1, 0, 0, -1, 0, 1, 0, 0, 0, 0, 1, 1]}])");
    const Picture byInstances = picture(view);
    const Means a = meansOf(byVertices, ""), b = meansOf(byInstances, "");
    for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(a[c], b[c], 0.002 * a[c]) << c;
    EXPECT_GT(a[0], 1.01 * a[1]) << "the red one is seen";
}

TEST_F(SidecarScene, CamerasAreThoseOfTheOptionsAndGiveWayToThem) {
    const std::string light =
        R"("lights": [{"type": "point", "position": [0, 2, 0], "intensity": 8}])";
    const Arguments small{"--size", "16x12"};
    scene(kGround, light);
    const Picture byOptions =
        picture(Arguments{"--eye", "1,3,5", "--look-at", "0,0,1", "--fov", "50"} + small + kQuick);
    scene(kGround, light + R"(, "cameras": [
        {"name": "side", "position": [1, 3, 5], "lookAt": [0, 0, 1], "fieldOfView": 50},
        {"name": "far", "position": [1, 30, 5]}])");
    const Picture bySidecar = picture(small + kQuick);
    expectSame(byOptions, bySidecar);
    expectSame(byOptions, picture(Arguments{"--camera", "side"} + small + kQuick));
    EXPECT_FALSE(areAlike(byOptions, picture(Arguments{"--camera", "far"} + small + kQuick)));
    EXPECT_FALSE(areAlike(byOptions, picture(Arguments{"--eye", "1,3,6"} + small + kQuick)));
    expectSame(byOptions, picture(Arguments{"--camera", "far", "--eye", "1,3,5", "--look-at",
                                            "0,0,1", "--fov", "50"} +
                                  small + kQuick));
    const Outcome unknown = run({"s.obj", "--camera", "top"});
    expectRefusal(unknown, 2, {"--camera 'top': the cameras of the scene are side, far"});
}

TEST_F(SidecarScene, IsNamedAndCanBeLeftOut) {
    const Arguments small{"--size", "16x12"};
    scene(kGround, "");
    const Picture without = picture(small + kQuick);
    scene(kGround, R"("environment": {"radiance": 7})");
    EXPECT_FALSE(areAlike(without, picture(small + kQuick)));
    expectSame(without, picture(Arguments{"--no-sidecar"} + small + kQuick));
    const Outcome told = run(Arguments{"s.obj", "-o", "t.exr"} + small + kQuick);
    EXPECT_NE(told.err.find("s.pm.json: is read with the scene"), std::string::npos) << told.err;
    const Outcome onto = run({"s.obj", "--stats", "s.pm.json"});
    expectRefusal(onto, 2, {"s.pm.json", "also an input"});
    write("s.pm.json", "{\"schema\": \"pm-sidecar/1\", \"lights\": [{\"type\": 1}]}");
    expectRefusal(run({"s.obj"}), 3, {"s.pm.json: lights[0].type is 1; it must be one of point"});
}

// A part of a scene with another sidecar is of another picture.
TEST_F(SidecarScene, IsInTheIdentityOfThePicture) {
    const Arguments view{"--size", "16x16", "--bucket-size", "8"};
    const auto part = [&](const char* rest, const char* buckets, const char* name) {
        scene(kGround, fmt::format(R"("environment": {{"radiance": 1}},
                                       "instances": [{{"of": "ground"{}}}])",
                                   rest));
        const Outcome done =
            run(Arguments{"s.obj", "-q", "--buckets", buckets, "-o", name} + view + kQuick);
        EXPECT_EQ(done.exitCode, 0) << done.err;
    };
    part("", "1/2", "a.pmpart");
    part(R"(, "hiddenFrom": ["shadow"])", "2/2", "b.pmpart");
    const Outcome merged = run({"merge", "a.pmpart", "b.pmpart", "-o", "m.exr"});
    EXPECT_EQ(merged.exitCode, 3) << merged.err;
    EXPECT_NE(merged.err.find("it differs in: geometry"), std::string::npos) << merged.err;
    part("", "2/2", "b.pmpart");
    EXPECT_EQ(run({"merge", "a.pmpart", "b.pmpart", "-o", "m.exr"}).exitCode, 0);
}

// The scene has no light: one is found, and a camera.
TEST_F(SidecarScene, WhatWasFoundAndWrittenGivesTheSameBits) {
    const Arguments view{"--size", "24x18", "--photons", "2000", "--passes", "2"};
    scene(kGround, "");
    write("s.obj", readText(path("s.obj")) + "v 0 0 0\nv 3 0 0\nv 0 4 0\nusemtl red\nf -3 -2 -1\n");
    const Picture found = picture(view);
    const Picture writing = picture(Arguments{"--write-sidecar"} + view);
    expectSame(found, writing);
    const std::string text = readText(path("s.pm.json"));
    EXPECT_NE(text.find("\"camera light\""), std::string::npos) << text;
    EXPECT_NE(text.find("\"fieldOfView\": 40"), std::string::npos) << text;
    expectSame(found, picture(view));
    EXPECT_EQ(m_warnings, "") << "nothing is guessed any more";
    // It says all already.
    expectSame(found, picture(Arguments{"--write-sidecar"} + view));
    EXPECT_EQ(readText(path("s.pm.json")), text);
    const Outcome refused = run({"s.obj", "--write-sidecar", "--no-sidecar"});
    expectRefusal(refused, 2, {"--write-sidecar: s.pm.json is there and --no-sidecar"});
    EXPECT_EQ(readText(path("s.pm.json")), text);
}

}  // namespace
}  // namespace pm::host::test
