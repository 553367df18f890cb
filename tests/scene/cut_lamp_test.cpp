// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Lamps that are cut by d and map_d shine as much less as there is less of them.
#include <fmt/format.h>

#include <fstream>

#include "tests/colour/scratch.h"
#include "tests/scene/host_test.h"
#include "tests/scene/picture_measures.h"

namespace pm::host::test {
namespace {

class CutLamp : public HostTest {
  protected:
    void SetUp() override {
        HostTest::SetUp();
        // Left half white, right half black.
        write("half.pgm", "P5\n64 1\n255\n" + std::string(32, '\xff') + std::string(32, '\0'));
        write("room.obj", kFloor + lampOf("-.5 .5"));
        write("half.obj", kFloor + lampOf("-.5 0"));
    }
    void write(const std::string& name, const std::string& text) const {
        std::ofstream(path(name), std::ios::binary) << text;
    }
    // A square lamp of side 1 that looks down, or a part of it along x.
    static std::string lampOf(const std::string& range) {
        const auto space = range.find(' ');
        const std::string from = range.substr(0, space), to = range.substr(space + 1);
        return fmt::format(
            "o lamp\nusemtl lamp\nv {0} 1 -.5\nv {1} 1 -.5\nv {1} 1 .5\nv {0} 1 .5\n"
            "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 5/1 6/2 7/3 8/4\n",
            from, to);
    }
    double lit(const std::string& scene, const std::string& lamp, const Arguments& more = {}) {
        write("a.mtl", "newmtl floor\nKd .5 .5 .5\nnewmtl lamp\nKd 0 0 0\nKe 10 10 10\n" + lamp);
        const Means means = meansOf(
            renderExr("a", Arguments{scene, "--eye", "0,3,8", "--look-at", "0,0,0", "--fov", "40",
                                     "--size", "64x48", "--passes", "8", "--camera-light", "off"} +
                               more));
        return (means[0] + means[1] + means[2]) / 3;
    }

    const std::string kFloor =
        "mtllib a.mtl\nv -10 0 -10\nv 10 0 -10\nv 10 0 10\nv -10 0 10\nusemtl floor\nf 4 3 2 1\n";
};

TEST_F(CutLamp, ShinesByWhatIsLeftOfIt) {
    for (const char* integrator : {"photon", "path"}) {
        const Arguments by{"--integrator", integrator};
        const double half = lit("half.obj", "", by), whole = lit("room.obj", "", by);
        EXPECT_NEAR(half, whole / 2, 0.005 * half) << integrator;
        for (const char* cut : {"d .5\n", "map_d half.pgm\n", "Tr .5\n"})
            EXPECT_NEAR(lit("room.obj", cut, by), half, 0.01 * half) << integrator << " " << cut;
        EXPECT_NEAR(lit("room.obj", "d .5\nmap_d half.pgm\n", by), half / 2, 0.01 * half)
            << integrator;
        // Between two texels the product of both is less than either.
        EXPECT_NEAR(lit("room.obj", "map_Ke half.pgm\nmap_d half.pgm\n", by),
                    half * (1 - 2.0 / 3 / 64), 0.005 * half)
            << integrator;
    }
}

// Round ones too, and photons: glass in the way makes of the light a caustic.
TEST_F(CutLamp, AlsoSpheresAndCaustics) {
    write("ball.obj", kFloor);
    write("ball.pm.json",
          R"({"schema": "pm-sidecar/1", "spheres": [
{"centre": [0, 1.5, 0], "radius": 0.3, "material": "lamp"},
{"centre": [0, 0.6, 0], "radius": 0.3, "material": "glass"}]})");
    const std::string glass = "newmtl glass\nillum 7\nNi 1.5\nTf 1 1 1\n";
    const double whole = lit("ball.obj", glass);
    EXPECT_GT(whole, 0);
    EXPECT_NEAR(lit("ball.obj", "d .5\n" + glass), whole / 2, 0.01 * whole);
    EXPECT_NEAR(lit("ball.obj", "map_d half.pgm\n" + glass), whole / 2, 0.02 * whole);
}

// Seen: its light by what is left of it, and what is behind by the rest.
TEST_F(CutLamp, IsSeenThrough) {
    write("wall.obj",
          "mtllib a.mtl\nv -9 -9 -2\nv 9 -9 -2\nv 9 9 -2\nv -9 9 -2\nusemtl wall\n"
          "f 1 2 3 4\nusemtl lamp\nv -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\n"
          "f 5 6 7 8\n");
    const Arguments front{"--eye", "0,0,10",       "--look-at", "0,0,0",
                          "--fov", "11.421186275", "--size",    "16x16"};
    EXPECT_NEAR(lit("wall.obj", "d .5\nnewmtl wall\nKd 0 0 0\nKe .25 .25 .25\n", front), 5.125,
                0.005);
    EXPECT_NEAR(lit("wall.obj", "d .1\nnewmtl wall\nKd 0 0 0\nKe .25 .25 .25\n", front), 1.225,
                0.005);
}

}  // namespace
}  // namespace pm::host::test
