// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Scenes as programs export them, and what they look like.
#include <fmt/format.h>

#include <cmath>
#include <fstream>

#include "host_shim/pictures/picture_io.h"
#include "tests/colour/scratch.h"
#include "tests/scene/host_test.h"
#include "tests/scene/picture_measures.h"

namespace pm::host::test {
namespace {

const fs::path kCases = fs::path(PM_SHARED_DATA).parent_path() / "cases";
constexpr int kRegions = 8;  // to a side

// Mean of the three channels in each of 8 x 8 regions, row by row.
std::vector<double> regionsOf(const Picture& picture) {
    const int width = picture.dataWindow.x1 - picture.dataWindow.x0;
    const int height = picture.dataWindow.y1 - picture.dataWindow.y0;
    std::vector<double> sums(kRegions * kRegions), counts(kRegions * kRegions);
    for (const char* name : {"R", "G", "B"}) {
        const float* channel = picture.find(name)->values.data();
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x) {
                const auto region = static_cast<std::size_t>(y * kRegions / height * kRegions +
                                                             x * kRegions / width);
                sums[region] += static_cast<double>(channel[y * width + x]);
                counts[region] += 1;
            }
    }
    for (std::size_t i = 0; i < sums.size(); ++i) sums[i] /= counts[i];
    return sums;
}

class Exporters : public HostTest {
  protected:
    void write(const std::string& name, const std::string& text) const {
        std::ofstream(path(name), std::ios::binary) << text;
    }
    double meanOf(const std::string& name, const Arguments& arguments) {
        const Means means = meansOf(renderExr(name, arguments));
        return (means[0] + means[1] + means[2]) / 3;
    }
};

// By Blender 3.4, against Cycles: plastic of 4 %, metal, a lamp that shines at the ceiling as well.
// Both are noisy, of so few samples; of more, nearly all regions are within 5 %.
TEST_F(Exporters, BlendersRoomLooksAsInCycles) {
    const fs::path folder = kCases / "blender_export";
    if (!fs::exists(folder)) GTEST_SKIP() << "no optional data at " << folder.string();
    const std::vector<double> right = regionsOf(readExr(folder / "cycles.exr"));
    const std::vector<double> ours = regionsOf(
        renderExr("room", {(folder / "room.obj").string(), "--eye", "0,1.5,6", "--look-at",
                           "0,1.5,0", "--fov", "35", "--size", "64x48", "--passes", "8"}));
    double sum = 0, sumRight = 0;
    int near = 0;
    for (std::size_t i = 0; i < right.size(); ++i) {
        const double off = ours[i] / right[i] - 1;
        EXPECT_LT(std::fabs(off), 0.17) << "row " << i / 8 << ", column " << i % 8;
        near += std::fabs(off) < 0.05 ? 1 : 0;
        sum += ours[i];
        sumRight += right[i];
    }
    std::cout << fmt::format("frame {:+.1f} %, {} of 64 regions within 5 %\n",
                             100 * (sum / sumRight - 1), near);
    EXPECT_NEAR(sum / sumRight, 1, 0.025);
    EXPECT_GE(near, 40);
}

const Arguments kAbove{"--eye", "0,1,3",  "--look-at", "0,0,0",    "--fov",
                       "40",    "--size", "24x16",     "--passes", "1"};

// In Blender a lamp's plane may face either way.
TEST_F(Exporters, BlendersLampsMayFaceAway) {
    const std::string floor = "usemtl f\nv -1 0 1\nv 1 0 1\nv 1 0 -1\nv -1 0 -1\nf 1 2 3 4\n";
    const std::string lamp = "usemtl l\nv -1 2 -1\nv 1 2 -1\nv 1 2 1\nv -1 2 1\n";
    write("a.mtl", "newmtl f\nKd 0.5 0.5 0.5\nKs 0 0 0\nillum 1\nnewmtl l\nKd 0 0 0\nKe 5 5 5\n");
    write("down.obj", "# Blender 3.6.0\nmtllib a.mtl\n" + floor + "o l\n" + lamp + "f 5 6 7 8\n");
    write("up.obj", "# Blender 3.6.0\nmtllib a.mtl\n" + floor + "o l\n" + lamp + "f 8 7 6 5\n");
    const double down = meanOf("down", Arguments{"down.obj"} + kAbove);
    EXPECT_GT(down, 0.05);
    EXPECT_NEAR(meanOf("up", Arguments{"up.obj"} + kAbove), down, 0.03 * down);
    // Elsewhere only the front shines.
    EXPECT_LT(meanOf("front", Arguments{"up.obj", "--mtl-dialect", "generic"} + kAbove),
              0.01 * down);
}

// What Maya writes for a red wall: without its head it is glass of air, and that is told.
TEST_F(Exporters, MayasWallsAreNoGlass) {
    const std::string wall =
        "mtllib a.mtl\ng default\nv -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nusemtl m\nf 1 2 3 4\n";
    write("a.mtl", "newmtl m\nillum 4\nKd 0.5 0.5 0.5\nKa 0 0 0\nTf 1.00 1.00 1.00\nNi 1.00\n");
    write("maya.obj",
          "# This file uses centimeters as units for non-parametric coordinates.\n\n" + wall);
    write("bare.obj", wall);
    EXPECT_GT(meanOf("maya", Arguments{"maya.obj"} + kAbove), 0.01);
    EXPECT_EQ(meanOf("bare", Arguments{"bare.obj"} + kAbove), 0);
    EXPECT_NE(m_warnings.find("--mtl-dialect maya"), m_warnings.npos) << m_warnings;
    EXPECT_GT(meanOf("asked", Arguments{"bare.obj", "--mtl-dialect", "maya"} + kAbove), 0.01);
    const Outcome told = run(Arguments{"maya.obj", "--explain"});
    EXPECT_NE(told.out.find("materials: a.mtl is read as maya, since the header of maya.obj says "
                            "Maya"),
              told.out.npos)
        << told.out;
}

// A texture beside the scene's folder is read by who trusts the scene alone.
TEST_F(Exporters, UntrustedScenesReadNothingElsewhere) {
    fs::create_directories(path("scene"));
    write("secret.mtl", "newmtl m\nKd 0.5 0 0\n");
    write("scene/a.obj", "mtllib ../secret.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\n");
    const Outcome trusted = run(Arguments{"scene/a.obj", "--explain"});
    EXPECT_NE(trusted.out.find("secret.mtl is read as generic"), trusted.out.npos) << trusted.out;
    const Outcome outcome = run(Arguments{"scene/a.obj", "--explain", "--untrusted"});
    EXPECT_EQ(outcome.exitCode, 0) << outcome.err;
    EXPECT_EQ(outcome.out.find("secret.mtl"), outcome.out.npos) << outcome.out;
    EXPECT_NE(outcome.err.find("--untrusted allows no other folder"), outcome.err.npos)
        << outcome.err;
    const Outcome searched = run(
        Arguments{"scene/a.obj", "--explain", "--untrusted", "--search-path", path("").string()});
    EXPECT_NE(searched.out.find("secret.mtl is read as generic"), searched.out.npos)
        << searched.err;
}

}  // namespace
}  // namespace pm::host::test
