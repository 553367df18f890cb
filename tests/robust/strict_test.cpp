// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Samples that are no light: counted, named, and an error with --strict.
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "tests/robust/host_process.h"

namespace pm::host::test {
namespace {

class Strict : public HostProcess {
  protected:
    // Lamps so bright that light and its reflection together are beyond a float.
    void SetUp() override {
        HostProcess::SetUp();
        write("bright.mtl",
              "newmtl light\nKd 0.9 0.9 0.9\nKe 3e38 3e38 3e38\nnewmtl wall\nKd 0.9 0.9 0.9\nKe "
              "3e38 3e38 3e38\n");
        std::string scene = readText(path("box.obj"));
        write("bright.obj", scene.replace(scene.find("box.mtl"), 7, "bright.mtl"));
    }
    Outcome renderBright(std::vector<std::string> more) const {
        std::vector<std::string> arguments{"bright.obj", "--size",     "16x16", "--passes",
                                           "2",          "-q",         "-o",    "bright.exr",
                                           "--stats",    "bright.json"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return run(arguments);
    }
};

TEST_F(Strict, BadSamplesNeverReachAFileAndAreNamed) {
    const Outcome outcome = renderBright({});
    EXPECT_EQ(outcome.exitCode, 0) << outcome.err;
    const auto json = nlohmann::json::parse(readText(path("bright.json")));
    ASSERT_TRUE(json.contains("badSamples")) << outcome.err;
    const auto& bad = json["badSamples"];
    EXPECT_EQ(bad["counts"]["infinite"], json["counters"]["badSamples"]);
    EXPECT_GT(bad["counts"]["infinite"], 0);
    const std::string pixel = std::to_string(bad["first"]["x"].get<int>()) + "," +
                              std::to_string(bad["first"]["y"].get<int>());
    EXPECT_NE(outcome.err.find("--only-pixel " + pixel), std::string::npos) << outcome.err;
    EXPECT_NE(outcome.err.find("sample " + std::to_string(bad["first"]["sample"].get<int>())),
              std::string::npos)
        << outcome.err;
    for (const Channel& channel : readExr(path("bright.exr")).channels) {
        if (!channel.isColour) continue;
        EXPECT_TRUE(std::ranges::all_of(channel.values, [](float v) {
            return std::isfinite(v) && v >= 0;
        })) << channel.name;
    }
    // The command that is named shows the same.
    EXPECT_NE(run({"bright.obj", "--size", "16x16", "--passes", "2", "-q", "--only-pixel", pixel})
                  .err.find("infinite"),
              std::string::npos);
}

// Buckets are of whole blocks of pixels; those beyond the picture are nobody's.
TEST_F(Strict, PixelsBeyondThePictureDoNotCount) {
    const auto countOf = [&](const std::string& size) {
        EXPECT_EQ(renderBright({"--size", size, "--aa", "2", "--passes", "8"}).exitCode, 0);
        const auto json = nlohmann::json::parse(readText(path("bright.json")));
        return json["counters"]["badSamples"].get<double>();
    };
    const double small = countOf("10x10"), large = countOf("16x16");
    EXPECT_GT(small, 0);
    EXPECT_LT(small, 0.55 * large);
}

TEST_F(Strict, IsAnErrorThatLeavesThePicture) {
    const Outcome outcome = renderBright({"--strict"});
    EXPECT_EQ(outcome.exitCode, 3) << outcome.err;
    EXPECT_TRUE(fs::exists(path("bright.exr")));
    const auto json = nlohmann::json::parse(readText(path("bright.json")));
    EXPECT_EQ(json["stopReason"], "bad samples");
    EXPECT_EQ(json["exitCode"], 3);
    EXPECT_EQ(render({"--strict", "-o", "box.exr"}).exitCode, 0);
}

}  // namespace
}  // namespace pm::host::test
