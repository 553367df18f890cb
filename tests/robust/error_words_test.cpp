// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// What pm_host says of its pictures' error in words, against long renders by the same view: it says
// "clean at 8 bits" of none of ten pictures, each at four exposures, that isn't, and of many that
// are.
#include <cstdio>
#include <nlohmann/json.hpp>

#include "host_shim/pictures/display_compare.h"
#include "tests/robust/host_process.h"

namespace pm::host::test {
namespace {

constexpr double kCleanShare = 0.95;

class ErrorWordsOfRenders : public HostProcess {
  protected:
    // A part of a small picture.
    void renderPart(const std::string& scene, const std::vector<std::string>& how,
                    const std::string& part) {
        std::vector<std::string> words{
            std::string(PM_SOURCE_DIR) + "/scenes/" + scene, "-q", "--size", "24x18", "-o", part};
        words.insert(words.end(), how.begin(), how.end());
        const Outcome outcome = run(words);
        ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
    }
    // Its display picture at an exposure, with statistics.
    DisplayPicture shown(const std::string& part, int stops) {
        const Outcome outcome = run({"merge", part, "-q", "-o", "shown.png", "--exposure",
                                     std::to_string(stops), "--stats", "shown.json"});
        EXPECT_EQ(outcome.exitCode, 0) << outcome.err;
        return readDisplayPicture(path("shown.png"));
    }
    nlohmann::json statistics() const {
        return nlohmann::json::parse(readText(path("shown.json")));
    }
};

// Of the pixels, those within one code in each channel.
double shareWithinACode(const DisplayPicture& a, const DisplayPicture& b) {
    std::size_t within = 0;
    for (std::size_t i = 0; i + 2 < a.values.size(); i += 3) {
        float most = 0;
        for (std::size_t c = i; c < i + 3; ++c)
            most = std::max(most, std::abs(a.values[c] - b.values[c]));
        if (most <= 1.5f / 255) ++within;
    }
    return 3 * static_cast<double>(within) / static_cast<double>(a.values.size());
}

TEST_F(ErrorWordsOfRenders, CallNothingCleanThatIsNot) {
    int said = 0, unsaid = 0, isNot = 0;
    std::printf("%-28s passes stops  told codes  within a code  words\n", "scene");
    for (const char* scene :
         {"regression/no_lamp.obj", "regression/many_lamps.obj", "regression/smooth_ball.obj",
          "regression/subdivided.obj", "cornell_box/cornell_box.obj"}) {
        renderPart(scene, {"--passes", "96", "--seed", "77"}, "long.pmpart");
        for (const char* passes : {"4", "24"})
            renderPart(scene, {"--passes", passes}, std::string(passes) + ".pmpart");
        for (const int stops : {-5, -3, -1, 1}) {
            const DisplayPicture reference = shown("long.pmpart", stops);
            for (const char* passes : {"4", "24"}) {
                const double share =
                    shareWithinACode(shown(std::string(passes) + ".pmpart", stops), reference);
                const nlohmann::json told = statistics();
                const auto words = told.at("errorWords").get<std::string>();
                const bool isClean = words.starts_with("clean at 8 bits");
                std::printf("%-28s %6s %5d %11.2f %14.3f  %s\n", scene, passes, stops,
                            told.at("errorCodes").at("all").get<double>(), share, words.c_str());
                if (isClean) {
                    EXPECT_GE(share, kCleanShare) << scene << " " << passes << " " << stops;
                }
                isNot += share < kCleanShare ? 1 : 0;
                said += isClean ? 1 : 0;
                unsaid += !isClean && share >= kCleanShare ? 1 : 0;
            }
        }
    }
    std::printf("clean: %d said, %d not said though true; %d are not clean\n", said, unsaid, isNot);
    // Both happen, or nothing was tried; and it is mostly said where it is true.
    EXPECT_GE(isNot, 10);
    EXPECT_GE(said, 10);
    EXPECT_LE(unsaid, said);
}

// In the log's line, the statistics and the report alike; without a display picture by relMSE.
TEST_F(ErrorWordsOfRenders, StandInLogStatisticsAndReport) {
    const Outcome outcome = run({"box.obj", "--size", "16x16", "--passes", "8", "-o", "a.png",
                                 "--stats", "a.json", "--report", "a.html"});
    ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
    const auto told = nlohmann::json::parse(readText(path("a.json")));
    const auto words = told.at("errorWords").get<std::string>();
    EXPECT_NE(words.find("% of the pixels within"), std::string::npos) << words;
    EXPECT_NE(outcome.err.find(": " + words + "\n"), std::string::npos) << outcome.err;
    EXPECT_NE(readText(path("a.html")).find("<td>" + words + "</td>"), std::string::npos);
    const Outcome linear = run({"box.obj", "--size", "16x16", "--passes", "8", "-o", "a.exr"});
    ASSERT_EQ(linear.exitCode, 0) << linear.err;
    EXPECT_NE(linear.err.find("differ by): "), std::string::npos) << linear.err;
    EXPECT_EQ(linear.err.find("% of the pixels within"), std::string::npos) << linear.err;
    // Of one pass no error is known, and no words.
    const Outcome one = run({"box.obj", "--size", "16x16", "--passes", "1", "-o", "a.png",
                             "--stats", "one.json", "--report", "one.html"});
    ASSERT_EQ(one.exitCode, 0) << one.err;
    EXPECT_FALSE(nlohmann::json::parse(readText(path("one.json"))).contains("errorWords"));
}

}  // namespace
}  // namespace pm::host::test
