// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// What a first picture shows: exposure, a light to see by, and why a picture is black.
#include <OpenImageIO/imageio.h>

#include <nlohmann/json.hpp>

#include "tests/robust/host_process.h"

namespace pm::host::test {
namespace {

class FirstLook : public HostProcess {
  protected:
    Outcome small(const std::string& scene, std::vector<std::string> more) const {
        std::vector<std::string> arguments{scene,       "--size", "16x12", "--passes", "1",
                                           "--photons", "500",    "--aa",  "1"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return run(arguments);
    }
    // The stops that a run told, as text; empty where it told none.
    static std::string told(const Outcome& outcome) {
        const std::string before = "exposure of display pictures: ";
        const auto at = outcome.err.find(before);
        if (at == std::string::npos) return {};
        const auto begin = at + before.size();
        return outcome.err.substr(begin, outcome.err.find(' ', begin) - begin);
    }
    std::string metadata(const std::string& name, const std::string& key) const {
        const auto input = OIIO::ImageInput::open(path(name).string());
        return input ? std::string(input->spec().get_string_attribute(key)) : "no file";
    }
    double meanCode(const std::string& name) const {
        const auto input = OIIO::ImageInput::open(path(name).string());
        if (!input) return -1;
        std::vector<std::uint8_t> bytes(input->spec().image_bytes());
        input->read_image(0, 0, 0, -1, OIIO::TypeDesc::UINT8, bytes.data());
        double sum = 0;
        for (const std::uint8_t byte : bytes) sum += byte;
        return sum / static_cast<double>(bytes.size());
    }
    void expectWarning(const Outcome& outcome, const std::vector<std::string>& parts) const {
        EXPECT_EQ(outcome.exitCode, 0) << outcome.err;
        for (const std::string& part : parts)
            EXPECT_NE(outcome.err.find(part), std::string::npos) << part << " in " << outcome.err;
    }
    // A ball's worth of blocks on a floor, and a lamp: faces 7 to 10 in one order or the other.
    void writeLit(const std::string& name, const std::string& lamp) const {
        write(name,
              "mtllib box.mtl\nv -2 0 -2\nv 2 0 -2\nv 2 0 2\nv -2 0 2\nv -.5 1 -1\n"
              "v .5 1 -1\nv .5 0 -1\nv -.5 0 -1\n" +
                  lamp + "usemtl wall\nf 4 3 2 1\nf 5 8 7 6\n");
    }
};

TEST_F(FirstLook, ExposureIsOfTheWholeFrameWhateverIsRendered) {
    const Outcome whole = small("box.obj", {"-o", "a.png", "-o", "a.exr"});
    const std::string stops = told(whole);
    ASSERT_FALSE(stops.empty()) << whole.err;
    EXPECT_NE(std::stod(stops), 0);
    EXPECT_EQ(metadata("a.png", "pm:exposure"), stops + " (auto)");
    for (const std::vector<std::string>& more : {std::vector<std::string>{"--crop", "3,2,9,8"},
                                                 {"--threads", "1"},
                                                 {"--passes", "2"},
                                                 {"--seed", "7"},
                                                 {"--integrator", "path"},
                                                 {"--frame", "3"},
                                                 {"--view", "raw"}}) {
        std::vector<std::string> arguments{"--exposure", "auto", "-o", "b.png"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        EXPECT_EQ(told(small("box.obj", arguments)), stops) << more[0];
    }
    // What is told repeats the picture; scene-linear files know nothing of it.
    ASSERT_EQ(small("box.obj", {"-o", "c.png", "-o", "c.exr", "--exposure", stops}).exitCode, 0);
    EXPECT_EQ(meanCode("a.png"), meanCode("c.png"));
    EXPECT_TRUE(readText(path("a.exr")) == readText(path("c.exr")));
    ASSERT_EQ(small("box.obj", {"-o", "d.exr"}).exitCode, 0);
    EXPECT_TRUE(readText(path("a.exr")) == readText(path("d.exr")));
}

TEST_F(FirstLook, ExposureIsNotMeasuredWherePicturesAreToMatch) {
    ASSERT_EQ(small("box.obj", {"-o", "r.exr"}).exitCode, 0);
    for (const std::vector<std::string>& more : {std::vector<std::string>{"--crop", "0,0,16,12"},
                                                 {"--frame", "3"},
                                                 {"--view", "untone-mapped"},
                                                 {"--reference", "r.exr"}}) {
        std::vector<std::string> arguments{"-o", "b.png"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        const Outcome outcome = small("box.obj", arguments);
        EXPECT_EQ(outcome.exitCode, 0) << outcome.err;
        EXPECT_EQ(told(outcome), "") << more[0];
        EXPECT_EQ(metadata("b.png", "pm:exposure"), "0") << more[0];
    }
}

TEST_F(FirstLook, ExposureIsInTheMetadataOfEveryFormat) {
    ASSERT_EQ(small("box.obj", {"-o", "a.png", "-o", "a.jpg", "-o", "a.tif", "--exposure", "-1.5",
                                "--stats", "s.json"})
                  .exitCode,
              0);
    for (const char* name : {"a.png", "a.jpg", "a.tif"})
        EXPECT_EQ(metadata(name, "ImageDescription"), "pm:exposure -1.5") << name;
    const auto json = nlohmann::json::parse(readText(path("s.json")));
    EXPECT_EQ(json.at("colour").at("exposureStops"), -1.5);
    ASSERT_EQ(small("box.obj", {"-o", "b.png", "--exposure", "1.5"}).exitCode, 0);
    EXPECT_GT(meanCode("b.png"), meanCode("a.png") + 20);
}

// A leaf of which the picture says where it ends: white there doesn't count. Alpha that is no
// outline, as how glossy a skin is, isn't taken as one.
TEST_F(FirstLook, TexelsThatAreNotThereAreNotMetered) {
    const auto picture = [&](const std::string& name, float leaf, float beside) {
        constexpr int kSide = 32;
        std::vector<float> values;
        for (int i = 0; i < kSide * kSide; ++i) {
            const bool isLeaf = i % kSide < kSide / 4;
            const float value = isLeaf ? 0.2f : 1.0f;
            values.insert(values.end(), {value, value, value, isLeaf ? leaf : beside});
        }
        const std::string file = path(name).string();
        const auto output = OIIO::ImageOutput::create(file);
        OIIO::ImageSpec spec(kSide, kSide, 4, OIIO::TypeUInt8);
        spec.attribute("oiio:UnassociatedAlpha", 1);
        ASSERT_TRUE(output && output->open(file, spec));
        ASSERT_TRUE(output->write_image(OIIO::TypeFloat, values.data()) && output->close());
        write(name + ".mtl", "newmtl m\nKd 1 1 1\nmap_Kd " + name + "\n");
        write(name + ".obj", "mtllib " + name +
                                 ".mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\n"
                                 "vt 1 1\nvt 0 1\nusemtl m\nf 1/1 2/2 3/3 4/4\n");
    };
    picture("leaf.png", 1, 0);
    picture("gloss.png", 0.3f, 0.2f);
    picture("opaque.png", 1, 1);
    const auto stops = [&](const std::string& scene, const std::vector<std::string>& more = {}) {
        std::vector<std::string> arguments{"-o", "a.png", "-o", "a.exr"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return told(small(scene, arguments));
    };
    const std::string right = stops("leaf.png.obj", {"--alpha-of-pictures"});
    ASSERT_FALSE(right.empty());
    EXPECT_EQ(stops("leaf.png.obj"), right);
    ASSERT_EQ(small("leaf.png.obj", {"-o", "b.exr"}).exitCode, 0);
    EXPECT_TRUE(readText(path("a.exr")) == readText(path("b.exr"))) << "what is rendered stays";
    const std::string whole = stops("opaque.png.obj");
    EXPECT_GT(std::stod(right), std::stod(whole) + 1);
    EXPECT_EQ(stops("gloss.png.obj"), whole);
    // And with the light at the camera that is added where the own one misses: behind the leaf.
    write("away.png.mtl", readText(path("leaf.png.mtl")) + "newmtl light\nKe 5 5 5\n");
    std::string scene = readText(path("leaf.png.obj"));
    scene.replace(scene.find("leaf.png.mtl"), 12, "away.png.mtl");
    write("away.png.obj",
          scene + "v .05 .4 -.001\nv .05 .6 -.001\nv .2 .4 -.001\nusemtl light\nf 5 6 7\n");
    EXPECT_NEAR(std::stod(stops("away.png.obj")), std::stod(right), 0.05);
}

// Lamps that shine to the other side, are closed away, or have next to no area.
TEST_F(FirstLook, ALightToSeeByWhereTheOwnOnesShowNothing) {
    writeLit("lit.obj",
             "v -.5 3 -.5\nv .5 3 -.5\nv .5 3 .5\nv -.5 3 .5\nusemtl light\nf 9 10 11 12\n");
    writeLit("away.obj",
             "v -.5 3 -.5\nv .5 3 -.5\nv .5 3 .5\nv -.5 3 .5\nusemtl light\nf 12 11 10 9\n");
    writeLit("tiny.obj",
             "v -.5 3 -.5\nv -.49999 3 -.5\nv -.5 3 -.49999\nusemtl light\nf 9 10 11\n");
    writeLit("closed.obj",
             "v -.1 1 -.1\nv .1 1 -.1\nv .1 1 .1\nv -.1 1 .1\nv 0 .5 0\n"
             "v -.01 .9 -.01\nv .01 .9 -.01\nv .01 .9 .01\n"
             "usemtl wall\nf 9 10 11 12\nf 9 10 13\nf 10 11 13\nf 11 12 13\nf 12 9 13\n"
             "usemtl light\nf 14 15 16\n");
    EXPECT_EQ(small("lit.obj", {"-o", "a.exr"}).err.find("warning"), std::string::npos);
    for (const char* scene : {"away.obj", "tiny.obj", "closed.obj"}) {
        const Outcome outcome = small(scene, {"-o", "b.png"});
        expectWarning(outcome, {"its own light reaches nothing", "--camera-light off"});
        EXPECT_EQ(outcome.err.find("is black"), std::string::npos) << outcome.err;
        EXPECT_GT(meanCode("b.png"), 5) << scene;
    }
    // Whatever is written and rendered of it.
    ASSERT_EQ(small("away.obj", {"-o", "w.exr"}).exitCode, 0);
    ASSERT_EQ(small("away.obj", {"-o", "v.exr", "-o", "v.png", "--threads", "1"}).exitCode, 0);
    EXPECT_TRUE(readText(path("w.exr")) == readText(path("v.exr")));
    // Who places the camera gets what there is, and a word.
    expectWarning(small("away.obj", {"-o", "c.exr", "--eye", "0,1,9"}),
                  {"the picture is black", "--camera-light on"});
    expectWarning(small("closed.obj", {"-o", "c.exr", "--camera-light", "off"}),
                  {"the picture is black", "--camera-light on"});
}

TEST_F(FirstLook, ABlackPictureSaysWhy) {
    write("cube.obj",
          "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n"
          "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 3 4 8 7\nf 1 5 8 4\nf 2 3 7 6\n");
    write("lamp.obj", "mtllib box.mtl\n" + readText(path("cube.obj")) +
                          "v 0 3 0\nv 1 3 0\nv 0 3 1\nusemtl light\nf 9 10 11\n");
    write("black.mtl", "newmtl black\nKd 0 0 0\n");
    write("black.obj", "mtllib black.mtl\nusemtl black\n" + readText(path("cube.obj")));
    const std::vector<std::string> inside{"-o",       "a.exr",     "--eye",
                                          ".5,.5,.5", "--look-at", "0,.5,0"};
    expectWarning(
        small("lamp.obj", inside),
        {"the picture is black as the camera stands inside of something closed", "--eye"});
    // No light at the camera would help: lit, unlit, or beside a lamp that is seen.
    const std::string black =
        "mtllib black.mtl\nmtllib box.mtl\nusemtl black\n" + readText(path("cube.obj"));
    for (const char* lamp : {"f 9 10 11", "f 11 10 9"}) {
        write("black_lit.obj", black + "v 0 1.5 0\nv .1 1.5 0\nv 0 1.5 .1\nusemtl light\n" + lamp);
        const Outcome outcome = small("black_lit.obj", {"-o", "a.exr"});
        expectWarning(outcome, {"100 % of what is seen reflects nothing", "--aov albedo"});
        EXPECT_EQ(outcome.err.find("camera light"), std::string::npos) << outcome.err;
    }
    expectWarning(small("black.obj", {"-o", "a.exr"}),
                  {"the picture is black", "reflect none of it", "--aov albedo"});
    expectWarning(small("cube.obj", {"-o", "a.exr", "--camera-light", "off"}),
                  {"the picture is black as the scene has no light", "--camera-light on"});
    expectWarning(small("cube.obj", {"-o", "a.exr", "--eye", "0,0,9", "--look-at", "0,0,20"}),
                  {"all of it lies behind the camera", "--look-at"});
    expectWarning(small("cube.obj", {"-o", "a.exr", "--eye", "0,0,9", "--look-at", "9,0,8"}),
                  {"the camera looks past it", "--look-at"});
    // Of what is mostly empty that is told, but not who chose where to stand, nor where a sky is
    // seen.
    write("pole.obj", "v 0 0 0\nv 2 0 0\nv 2 9 0\nv 0 9 0\nf 1 2 3 4\n");
    const std::string empty = "of the picture is empty";
    expectWarning(small("pole.obj", {"-o", "a.exr"}), {empty, "--environment"});
    for (const std::vector<std::string>& more : {std::vector<std::string>{"--eye", "0,4,12"},
                                                 {"--sun", "30,40"},
                                                 {"--crop", "0,0,16,12"}}) {
        std::vector<std::string> arguments{"-o", "a.exr"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        const Outcome outcome = small("pole.obj", arguments);
        EXPECT_EQ(outcome.exitCode, 0) << outcome.err;
        EXPECT_EQ(outcome.err.find(empty), std::string::npos) << outcome.err;
    }
    expectWarning(small("cube.obj", {"-o", "a.png", "--exposure", "-15"}),
                  {"a.png: nothing of the picture can be seen at an exposure of -15 stops",
                   "--exposure STOPS|auto"});
}

}  // namespace
}  // namespace pm::host::test
