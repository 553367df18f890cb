// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// What a render says of its scene and of itself, and what of it is new.
#include "host_shim/check/render_facts.h"

#include <gtest/gtest.h>

#include <fstream>

namespace pm::host {
namespace {

TEST(RenderFacts, AreOfStatisticsLogAndPicture) {
    const std::filesystem::path folder = ::testing::TempDir();
    const auto statistics = folder / "facts.json", log = folder / "facts.log";
    std::ofstream(statistics)
        << R"({"hashes": {"scene": "1", "settings": "2", "camera": "c", "object box": "b",)"
        << R"( "texture /suite/maps/wood.png": "w", "texture /elsewhere/sky.hdr": "s"}})";
    std::ofstream(log) << "pm_host: warning: /suite/box.mtl:3: wood.png: not found\n"
                       << "[0.1 s] rendering\n"
                       << "pm_host: warning: /suite/box.mtl:3: wood.png: not found\n"
                       << "pm_host: error\n";
    Picture picture;
    picture.attributes["pm:ocioCacheId"] = std::string("o");
    const RenderFacts facts = readFacts(statistics, log, picture, "/suite");
    EXPECT_EQ(facts.inputs, (SceneInputs{{"camera", "c"},
                                         {"config", "o"},
                                         {"object box", "b"},
                                         {"texture ../elsewhere/sky.hdr", "s"},
                                         {"texture maps/wood.png", "w"}}));
    EXPECT_EQ(facts.warnings, std::vector<std::string>{"box.mtl:3: wood.png: not found"});
}

TEST(RenderFacts, DifferencesAreNamed) {
    const SceneInputs before{{"camera", "1"}, {"material red", "1"}, {"object ball", "1"}};
    EXPECT_EQ(differences(before, before), "");
    EXPECT_EQ(differences(before, {{"camera", "2"}, {"material red", "3"}, {"object ball", "1"}}),
              "camera, material red");
    EXPECT_EQ(differences(before, {{"camera", "1"}, {"material blue", "1"}, {"object ball", "2"}}),
              "object ball; new: material blue; gone: material red");
    SceneInputs many;
    for (int i = 0; i < 30; ++i) many["object " + std::to_string(100 + i)] = "1";
    EXPECT_TRUE(differences({}, many).ends_with("object 107 and 22 more"));
}

TEST(RenderFacts, NumbersMakeNoWarningNew) {
    const std::vector<std::string> before{"box.mtl:12: wood1.png: 3 texels of 1.5e-03 are off"};
    EXPECT_TRUE(newWarnings(before, {"box.mtl:13: wood1.png: 40 texels of 2e+01 are off"}).empty());
    EXPECT_EQ(newWarnings(before, {"box.mtl:12: wood2.png: 3 texels of 1.5e-03 are off"}).size(),
              1u);
    EXPECT_EQ(newWarnings({}, before), before);
}

}  // namespace
}  // namespace pm::host
