// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Scenes with textures as both OBJ exporters of Blender write them, rendered here and by Cycles.
#include <fmt/format.h>

#include <cmath>
#include <cstdlib>

#include "host_shim/pictures/picture_io.h"
#include "tests/scene/host_test.h"
#include "tests/scene/picture_measures.h"

namespace pm::host::test {
namespace {

constexpr int kWidth = 64, kHeight = 48, kSide = 8;

// Exports the scene and renders it by Cycles, into the folder; false where there is no Blender.
bool exportByBlender(const std::string& scene, const std::string& folder) {
    if (std::system("command -v blender > /dev/null") != 0) return false;
    const std::string command = fmt::format(
        "blender -b --factory-startup -noaudio --python-exit-code 1 "
        "-P '{}/tests/blender/textured_scenes.py' -- '{}' 256 {} > '{}/blender.log' 2>&1",
        PM_SOURCE_DIR, folder, scene, folder);
    EXPECT_EQ(std::system(command.c_str()), 0) << "blender failed";
    return true;
}

// The mean of R, G and B over a region of kSide x kSide pixels.
double regionMean(const Picture& picture, int regionX, int regionY) {
    double sum = 0;
    for (const char* name : {"R", "G", "B"}) {
        const Channel* channel = picture.find(name);
        for (int y = 0; y < kSide; ++y)
            for (int x = 0; x < kSide; ++x)
                sum += channel->values[static_cast<std::size_t>((regionY * kSide + y) * kWidth +
                                                                regionX * kSide + x)];
    }
    return sum / (3.0 * kSide * kSide);
}

class Cycles : public HostTest, public testing::WithParamInterface<const char*> {};

TEST_P(Cycles, AgreesByRegionsWithBothExporters) {
    const std::string scene = GetParam();
    if (!exportByBlender(scene, path(""))) GTEST_SKIP() << "blender is not installed";
    const Picture truth = readExr(path("cycles_" + scene + ".exr"));
    ASSERT_TRUE(allFinite(truth));
    // Under the ball one region is 5.9 % off: Blender's diffuse part depends on angles, and the
    // coat is another; how much each has of it isn't known.
    // Metal beside what is none is 6.4 % brighter in one region, at the ball's rim: inside it all
    // agrees to 1 %, and where it is seen at a grazing angle Cycles 3.4 shows less.
    const double allowed = scene == "plastic" || scene == "helmet" ? 0.07 : 0.05;
    for (const std::string exporter : {"old", "new"}) {
        const std::string name = scene + "_" + exporter;
        // The camera of textured_scenes.py, in the exporters' axes.
        const Picture picture =
            renderExr("pm_" + name,
                      {path(name + ".obj"), "--eye", "0,2.2,5", "--look-at", "0,.6,-.3", "--fov",
                       "40", "--size", fmt::format("{}x{}", kWidth, kHeight), "--passes", "16",
                       "--camera-light", "off", "--rendering-space", "Linear Rec.709"});
        ASSERT_TRUE(allFinite(picture)) << m_warnings;
        for (int y = 0; y < kHeight / kSide; ++y)
            for (int x = 0; x < kWidth / kSide; ++x)
                EXPECT_NEAR(regionMean(picture, x, y) / regionMean(truth, x, y), 1, allowed)
                    << name << ", region " << x << ", " << y;
    }
}

INSTANTIATE_TEST_SUITE_P(Scenes, Cycles,
                         testing::Values("plastic", "metal", "screen", "leaves", "helmet",
                                         "barrel"),
                         [](const auto& info) { return std::string(info.param); });

}  // namespace
}  // namespace pm::host::test
