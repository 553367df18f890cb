// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Numbers beside their pictures, by the program that wrote them, and pictures that are not there.
#include <cmath>
#include <fstream>

#include "tests/colour/scratch.h"
#include "tests/scene/host_test.h"
#include "tests/scene/picture_measures.h"

namespace pm::host::test {
namespace {

// sRGB of code 188.
constexpr double kGrey = 0.5028864580325687;
const std::string kOldBlender = "# Blender MTL File: 'None'\n# Material Count: 1\n";
const std::string kNewBlender = "# Blender 3.4.1 MTL File: 'None'\n# www.blender.org\n";

class NumberAndPicture : public HostTest {
  protected:
    void SetUp() override {
        HostTest::SetUp();
        writePicture("grey.ppm", 188);
        writePicture("half.ppm", 128);
        writePicture("white.ppm", 255);
        write("a.obj",
              "mtllib a.mtl\nusemtl m\nv -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\n"
              "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3 4/4\n");
    }
    void write(const std::string& name, const std::string& text) const {
        std::ofstream(path(name), std::ios::binary) << text;
    }
    void writePicture(const std::string& name, int code) const {
        write(name, "P6\n2 2\n255\n" + std::string(12, static_cast<char>(code)));
    }
    // What a quad that fills the frame shows of that material, in even light of 1.
    double seen(const std::string& head, const std::string& material, const Arguments& more = {}) {
        write("a.mtl", head + "newmtl m\n" + material);
        const Means means = meansOf(
            renderExr("a", Arguments{"a.obj", "--eye", "0,0,10", "--look-at", "0,0,0", "--fov",
                                     "11.421186275", "--size", "16x16", "--integrator", "path",
                                     "--passes", "16", "--environment", "white.ppm"} +
                               more));
        return (means[0] + means[1] + means[2]) / 3;
    }
};

// .4 % to 1.2 % are what Blender's diffuse lobe reflects more than an even one.
TEST_F(NumberAndPicture, BlenderMeansThePictureAlone) {
    for (const std::string& head : {kOldBlender, kNewBlender})
        for (const char* number : {"Kd 0.8 0.8 0.8\n", "Kd 0 0 0\n", "Kd 1 0.2 0.1\n", ""})
            EXPECT_NEAR(seen(head, std::string(number) +
                                       "Ns 225\nKs 0 0 0\nKe 0 0 0\nillum 1\nmap_Kd grey.ppm\n"),
                        kGrey, 0.015 * kGrey)
                << head << number;
    // A metal of that colour.
    EXPECT_NEAR(
        seen(kOldBlender,
             "Ns 900\nKa 1 1 1\nKd 0.8 0.8 0.8\nKs 0.5 0.5 0.5\nillum 3\nmap_Kd grey.ppm\n"),
        kGrey, 0.01 * kGrey);
}

TEST_F(NumberAndPicture, ElsewhereTheyMultiply) {
    for (const char* head : {"", "# Blender 4.2.0 MTL File: 'None'\n"})
        EXPECT_NEAR(seen(head, "Kd 0.8 0.8 0.8\nKs 0 0 0\nillum 1\nmap_Kd grey.ppm\n"), 0.8 * kGrey,
                    0.01 * kGrey)
            << head;
    EXPECT_NEAR(seen(kOldBlender, "Kd 0.8 0.8 0.8\nmap_Kd grey.ppm\nillum 1\n",
                     {"--mtl-dialect", "generic"}),
                0.8 * kGrey, 0.01 * kGrey);
}

TEST_F(NumberAndPicture, ANumberThatSaysNothingIsTold) {
    seen(kOldBlender, "Kd 0 0 0\nillum 1\nmap_Kd grey.ppm\n");
    EXPECT_NE(m_warnings.find("a.mtl:4: material m: Kd 0 0 0 beside map_Kd says nothing"),
              m_warnings.npos)
        << m_warnings;
    seen("", "Kd 0 0 0\nillum 1\nmap_Kd grey.ppm\n");
    EXPECT_NE(m_warnings.find("Kd 0 0 0 multiplies map_Kd, so the map has no effect"),
              m_warnings.npos)
        << m_warnings;
}

// What a coat takes is made up for beside a picture as beside a number, up to white.
TEST_F(NumberAndPicture, APictureIsAsBrightAsItsNumber) {
    for (const char* rest : {"Ks 0.5 0.5 0.5\nPr 0.6\nillum 2\n", "Ks 1 1 1\nPr 0.3\nillum 2\n",
                             "Ks 0.5 0.5 0.5\nPr 0.6\nTf 0.2 0.2 0.2\nillum 2\n"}) {
        const std::string number = "Kd 0.5028864580325687 0.5028864580325687 0.5028864580325687\n";
        const double byNumber = seen(kNewBlender, number + rest);
        EXPECT_NEAR(seen(kNewBlender, std::string(rest) + "map_Kd grey.ppm\n"), byNumber,
                    0.002 * byNumber)
            << rest;
    }
    EXPECT_LE(seen(kNewBlender, "Ks 0.5 0.5 0.5\nPr 0.6\nillum 2\nmap_Kd white.ppm\n"), 1.005);
}

TEST_F(NumberAndPicture, ThePictureIsHowRoughAnyKindIs) {
    // Half is dark, half light: what is smooth shows what is right before it.
    write("sky.ppm", "P6\n2 2\n255\n" + std::string("\0\0\0\xff\xff\xff\0\0\0\xff\xff\xff", 12));
    const Arguments sky{"--environment", "sky.ppm"};
    for (const char* kind : {"illum 5\nKs 1 1 1\nKd 0 0 0\n", "illum 7\nNi 1.5\n",
                             "illum 3\nKs 0.9 0.9 0.9\nKd 0 0 0\n"}) {
        const double right = seen("", std::string(kind) + "Pr 1\nmap_Pr half.ppm\n", sky);
        EXPECT_EQ(seen("", std::string(kind) + "map_Pr half.ppm\n", sky), right) << kind;
        EXPECT_NE(seen("", kind, sky), right) << kind;
    }
    // Both of Blender's exporters call it map_Ns; 128/255 is no roughness of .5, quite.
    const std::string metal = "Ka 1 1 1\nKd 0.9 0.9 0.9\nKs 0.5 0.5 0.5\nillum 3\n";
    const double right = seen(kNewBlender, metal + "Pr 0.50196078\n", sky);
    for (const std::string& head : {kOldBlender, kNewBlender})
        EXPECT_NEAR(seen(head, metal + "Ns 0\nmap_Ns half.ppm\n", sky), right, 1e-4 * right);
}

TEST_F(NumberAndPicture, ALampWhosePictureIsMissingIsNone) {
    const Arguments own{"--environment", "white.ppm", "--environment-strength", "0"};
    for (const char* head : {"", kOldBlender.c_str()})
        for (const char* name : {"none.png", "a.obj"}) {
            const std::string lamp =
                std::string("Kd 0.5 0.5 0.5\nKe 3 3 3\nillum 1\nmap_Ke ") + name + "\n";
            EXPECT_EQ(seen(head, lamp, own + Arguments{"--camera-light", "off"}), 0) << lamp;
            EXPECT_NE(m_warnings.find("it gives no light"), m_warnings.npos) << m_warnings;
        }
    write("a.mtl", "newmtl m\nKd 0.5 0.5 0.5\nKe 3 3 3\nmap_Ke none.png\n");
    renderExr("lit", {"a.obj", "--size", "16x16", "--passes", "1"});
    EXPECT_NE(m_warnings.find("a point light at the camera is added"), m_warnings.npos)
        << m_warnings;
}

TEST_F(NumberAndPicture, AColourWhosePictureIsMissingIsGrey) {
    EXPECT_NEAR(seen("", "illum 1\nmap_Kd none.png\n"), 0.8, 0.005);
    EXPECT_NE(m_warnings.find("0.8 is taken in its place"), m_warnings.npos) << m_warnings;
    EXPECT_NEAR(seen("", "Kd 0.3 0.3 0.3\nillum 1\nmap_Kd none.png\n"), 0.3, 0.003);
    EXPECT_NEAR(seen(kOldBlender, "Kd 0.3 0.3 0.3\nKs 0 0 0\nillum 1\nmap_Kd none.png\n"), 0.8,
                0.01);
    EXPECT_NEAR(seen("", "illum 1\nmap_Kd none.png\n", {"--untrusted"}), 0.8, 0.005);
}

TEST_F(NumberAndPicture, OneNumberOfAColourInASidecarIsGrey) {
    write("a.pm.json", R"({"schema": "pm-sidecar/1", "materials": {"m": {"diffuse": 0.25}}})");
    EXPECT_NEAR(seen("", "Kd 0.9 0.1 0.1\nillum 1\n"), 0.25, 0.001);
    write("a.pm.json", R"({"schema": "pm-sidecar/1", "materials": {"m": {"emission": 3}}})");
    EXPECT_NEAR(seen("", "Kd 0 0 0\nillum 1\n"), 3, 0.001);
}

TEST_F(NumberAndPicture, ASkyThatIsNoPictureIsAnError) {
    write("a.mtl", "newmtl m\n");
    for (const char* name : {"a.obj", "empty.exr"}) {
        write("empty.exr", "");
        const Outcome ended = run({"a.obj", "--environment", name, "--size", "16x16"});
        EXPECT_NE(ended.exitCode, 0) << name;
        EXPECT_NE(ended.err.find(std::string("--environment: ")), ended.err.npos) << ended.err;
        EXPECT_NE(ended.err.find(name), ended.err.npos) << ended.err;
    }
}

}  // namespace
}  // namespace pm::host::test
