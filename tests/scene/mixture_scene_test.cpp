// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Materials mixed of others by the sidecar, and by MTL's picture of what is metal.
#include <fstream>

#include "tests/scene/host_test.h"
#include "tests/scene/picture_measures.h"

namespace pm::host::test {
namespace {

class Mixtures : public HostTest {
  protected:
    void SetUp() override {
        HostTest::SetUp();
        write("white.ppm", "P6\n1 1\n255\n\xff\xff\xff");
        // Left black, right white.
        write("half.ppm", "P6\n16 1\n255\n" + std::string(24, '\0') + std::string(24, '\xff'));
        write("a.obj",
              "mtllib a.mtl\nusemtl m\nv -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\n"
              "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3 4/4\n");
    }
    void write(const std::string& name, const std::string& text) const {
        std::ofstream(path(name), std::ios::binary) << text;
    }
    // A quad that fills the frame, in even light of 1.
    Picture seen(const std::string& mtl, const std::string& sidecar = "") {
        write("a.mtl", mtl);
        write("a.pm.json", R"({"schema": "pm-sidecar/1", "materials": {)" + sidecar + "}}");
        return renderExr("a",
                         {"a.obj", "--eye", "0,0,10", "--look-at", "0,0,0", "--fov", "11.421186275",
                          "--size", "16x16", "--passes", "16", "--environment", "white.ppm"});
    }
    static double meanOfRed(const Picture& picture, int x0, int x1) {
        double sum = 0;
        for (int y = 0; y < 16; ++y)
            for (int x = x0; x < x1; ++x)
                sum += picture.find("R")->values[static_cast<std::size_t>(y * 16 + x)];
        return sum / (16.0 * (x1 - x0));
    }
};

const std::string kParts =
    "newmtl m\nKd 1 0 0\nillum 1\nnewmtl dark\nKd 0.2 0.2 0.2\nillum 1\n"
    "newmtl bright\nKd 0 0 0\nKs 0.8 0.8 0.8\nillum 3\n";

TEST_F(Mixtures, ByANumber) {
    const Picture picture = seen(
        kParts, R"("m": {"kind": "mixture", "first": "dark", "second": "bright", "weight": 0.3})");
    EXPECT_NEAR(meanOfRed(picture, 0, 16), 0.7 * 0.2 + 0.3 * 0.8, 2e-3) << m_warnings;
}

TEST_F(Mixtures, ByAPicture) {
    const Picture picture = seen(
        kParts,
        R"("m": {"kind": "mixture", "first": "dark", "second": "bright", "weight": 1, "weightTexture": "half.ppm"})");
    EXPECT_NEAR(meanOfRed(picture, 2, 6), 0.2, 1e-3) << m_warnings;
    EXPECT_NEAR(meanOfRed(picture, 10, 14), 0.8, 1e-3);
}

TEST_F(Mixtures, OfMixtures) {
    const Picture picture =
        seen(kParts + "newmtl both\nKd 0 0 0\nillum 1\n",
             R"("both": {"kind": "mixture", "first": "dark", "second": "bright", "weight": 0.5},
           "m": {"kind": "mixture", "first": "both", "second": "dark", "weight": 0.5})");
    EXPECT_NEAR(meanOfRed(picture, 0, 16), 0.75 * 0.2 + 0.25 * 0.8, 2e-3) << m_warnings;
}

TEST_F(Mixtures, OfWhatIsNotThereAreRefused) {
    write("a.mtl", kParts);
    const auto refused = [&](const std::string& sidecar) {
        write("a.pm.json", R"({"schema": "pm-sidecar/1", "materials": {)" + sidecar + "}}");
        return run({path("a.obj"), "--size", "8x8", "--passes", "1", "-o", path("x.exr")});
    };
    const auto none = refused(R"("m": {"kind": "mixture", "first": "dark", "second": "silver"})");
    EXPECT_EQ(none.exitCode, 3);
    EXPECT_NE(none.err.find("is 'silver', which no material library of the scene has"),
              std::string::npos)
        << none.err;
    const auto itself = refused(R"("m": {"kind": "mixture", "first": "m", "second": "dark"})");
    EXPECT_NE(itself.exitCode, 0);
    EXPECT_NE(itself.err.find("part of itself"), std::string::npos) << itself.err;
    const auto half = refused(R"("m": {"kind": "mixture", "first": "dark"})");
    EXPECT_NE(half.err.find("its first and second have to be set"), std::string::npos) << half.err;
}

// Metal of .9 where the picture is white; what is none reflects Kd, and a coat that takes as much.
TEST_F(Mixtures, MetalByAPictureOfMtl) {
    const Picture picture =
        seen("newmtl m\nKd 0.9 0.9 0.9\nKs 0 0 0\nPr 0.5\nPm 1\nmap_Pm half.ppm\n");
    EXPECT_NEAR(meanOfRed(picture, 2, 6), 0.9, 0.01) << m_warnings;
    EXPECT_NEAR(meanOfRed(picture, 10, 14), 0.9, 0.02);
    const Picture none =
        seen("newmtl m\nKd 0.9 0.9 0.9\nKs 0 0 0\nPr 0.5\nPm 0\nmap_Pm half.ppm\n");
    EXPECT_NEAR(meanOfRed(none, 10, 14), 0.9, 0.01);
    EXPECT_EQ(m_warnings.find("map_Pm"), std::string::npos) << m_warnings;
}

}  // namespace
}  // namespace pm::host::test
