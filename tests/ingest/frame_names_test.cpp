// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Numbers of frames in names of files, and names that only look so.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "host_shim/cli/command_line.h"
#include "host_shim/cli/option_values.h"
#include "tests/ingest/heard.h"

namespace pm::host::test {
namespace {

TEST(CommandLine, framePatterns) {
    EXPECT_EQ(withFrame("-o", "a.####.exr", FrameNumber{12}), "a.0012.exr");
    EXPECT_EQ(withFrame("-o", "a.%04d.exr", FrameNumber{12}), "a.0012.exr");
    EXPECT_EQ(withFrame("-o", "a.%d.exr", FrameNumber{12}), "a.12.exr");
    EXPECT_EQ(withFrame("-o", "100%.exr", FrameNumber{12}), "100%.exr");
    EXPECT_TRUE(
        errorOf([] { withFrame("-o", "a.##.exr", FrameNumber{}); }).starts_with("2 -o 'a.##.exr'"));
    for (const char* folder : {"/x/shot #1/", "a%d/", "./%04d##/", "##/%d/"}) {
        EXPECT_EQ(withFrame("-o", std::string(folder) + "a.exr", FrameNumber{}),
                  std::string(folder) + "a.exr");
        EXPECT_EQ(withFrame("-o", std::string(folder) + "a#.exr", FrameNumber{7}),
                  std::string(folder) + "a7.exr");
        EXPECT_EQ(withFrame("-o", folder, FrameNumber{7}), folder);
    }
}

// A file of that very name is meant: of what is read always, of what is written without a frame.
TEST(CommandLine, namesThatLookLikeFramePatterns) {
    const std::filesystem::path folder =
        std::filesystem::path(testing::TempDir()) / ("shot #1 %d " + std::to_string(getpid()));
    std::filesystem::create_directories(folder);
    for (const char* name : {"part #2", "a%d", "b%04d##"}) {
        const std::string scene = folder / (std::string(name) + ".obj");
        const std::string output = folder / (std::string(name) + ".exr");
        for (const std::string& file : {scene, output}) std::ofstream(file) << "\n";
        const Options alone = parseCommandLine({scene});
        EXPECT_EQ(alone.scene, scene);
        EXPECT_EQ(alone.outputs.at(0), std::string(name) + ".exr") << "in the working folder";
        EXPECT_EQ(parseCommandLine({scene, "-o", output}).outputs.at(0), output);
        const Options frame = parseCommandLine({scene, "-o", output, "--frame", "7"});
        EXPECT_EQ(frame.scene, scene);
        EXPECT_EQ(frame.outputs.at(0), withFrame("-o", output, FrameNumber{7}));
        EXPECT_NE(frame.outputs.at(0), output);
        EXPECT_EQ(frame.outputs.at(0).parent_path(), folder);
        std::filesystem::remove(scene);
        EXPECT_TRUE(errorOf([&] { parseCommandLine({scene}); }).starts_with("2 SCENE"));
        EXPECT_EQ(parseCommandLine({"merge", output, "-o", "m.exr", "--frame", "7"}).merge.at(0),
                  output);
        // What a farm makes of them later.
        EXPECT_EQ(parseCommandLine({"merge", "x#.pmpart", "-o", "m#.exr"}, true).outputs.at(0),
                  "m#.exr");
    }
    const std::string parts = folder / "parts #3";  // not there yet
    EXPECT_EQ(parseCommandLine({"watch", parts, "-o", "w.exr"}).merge.at(0), parts);
    EXPECT_EQ(parseCommandLine({"pack", "s.obj", "-o", parts}).outputs.at(0), parts);
    std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace pm::host::test
