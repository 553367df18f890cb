// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// The command line of a farm, and which of its words its processes get.
#include <gtest/gtest.h>

#include <algorithm>

#include "host_shim/cli/command_line.h"
#include "host_shim/cli/frame_options.h"
#include "host_shim/farm/farm_words.h"
#include "host_shim/pictures/frame_numbers.h"
#include "tests/colour/scratch.h"

namespace pm::host::test {
namespace {

using Words = std::vector<std::string>;

Options parsed(Words words) {
    Options options = parseCommandLine(words);
    options.commandLine = words;
    return options;
}

Options farmOf(const Words& more) {
    Words words{"farm", "a.obj", "--engine", "parallel", "--job", "j"};
    words.insert(words.end(), more.begin(), more.end());
    return parsed(words);
}

TEST(FarmCommand, HasOptionsOfItsOwn) {
    const Options plain = farmOf({});
    EXPECT_EQ(plain.farm->engine, "parallel");
    EXPECT_EQ(plain.farm->runs, 0);
    EXPECT_EQ(plain.farm->tries, 3);
    EXPECT_EQ(plain.outputs.at(0), "a.exr");
    const Options all = farmOf({"--runs", "7", "--tries", "2", "--sshlogin", "h1", "--sshlogin",
                                "h2", "--at-once", "4", "--dry-run", "--size", "8x8"});
    EXPECT_EQ(all.farm->runs, 7);
    EXPECT_EQ(all.farm->tries, 2);
    EXPECT_EQ(all.farm->sshLogins, (Words{"h1", "h2"}));
    EXPECT_EQ(all.farm->atOnce, 4);
    EXPECT_TRUE(all.farm->dryRun);
    EXPECT_EQ(all.width, 8);
    EXPECT_FALSE(parsed({"a.obj"}).farm.has_value());
    EXPECT_TRUE(parseCommandLine({"farm", "-h"}).helpOfFarm);
}

TEST(FarmCommand, RefusesWhatAFarmCantDo) {
    const auto refused = [](const Words& words) { return refusal([&] { farmOf(words); }); };
    for (const Words& words : {Words{"--buckets", "1/2", "-o", "a.pmpart"},
                               {"--checkpoint", "c"},
                               {"--time-limit", "3"},
                               {"--error-target", "0.1"},
                               {"--only-pixel", "1,1"},
                               {"--explain"},
                               {"--bucket-order", "correlated"},
                               {"--bucket-size", "auto"},
                               {"--strict"},
                               {"--photons-only", "--photon-map", "m"}})
        EXPECT_EQ(refused(words).substr(0, 2), "2 ") << words.front();
    EXPECT_TRUE(refusesWith(refused({"-o", "a.pmpart"}), 2, {"no .pmpart"}));
    EXPECT_TRUE(refusesWith(refused({"--runs", "0"}), 2, {"--runs"}));
    EXPECT_TRUE(refusesWith(refused({"--slurm-option", "--x"}), 2, {"--engine slurm"}));
    EXPECT_TRUE(refusesWith(refusal([] {
                                parsed({"farm", "a.obj", "--job", "j"});
                            }),
                            2, {"--engine", "slurm, parallel, commands"}));
    EXPECT_TRUE(refusesWith(refusal([] {
                                parsed({"farm", "a.obj", "--engine", "slurm"});
                            }),
                            2, {"--job"}));
    EXPECT_NO_THROW(parsed({"farm", "a.obj", "--engine", "slurm", "--job", "a#"}));
}

bool has(const Words& words, const std::string& word) {
    return std::ranges::find(words, word) != words.end();
}

TEST(FarmWords, TasksGetWhatDecidesOnPixels) {
    const Options options =
        farmOf({"--eye",         "-1,2,3",    "-q",  "--runs",  "3",      "-o",
                "x.png",         "--aov",     "N",   "--aov",   "Z",      "--view",
                "raw",           "--context", "A=b", "--stats", "s.json", "--untrusted",
                "--bucket-size", "16"});
    const Words render = renderWords(options, 12);
    EXPECT_EQ(render.front(), "a.obj");
    for (const char* word : {"--eye", "-1,2,3", "N", "Z", "--view", "A=b", "--untrusted", "12"})
        EXPECT_TRUE(has(render, word)) << word;
    for (const char* word :
         {"--quiet", "-q", "--runs", "x.png", "s.json", "--job", "--engine", "--bucket-size"})
        EXPECT_FALSE(has(render, word)) << word;
    EXPECT_FALSE(has(photonWords(options, 12), "--aov"));
    const Words merge = mergeWords(options);
    for (const char* word : {"-o", "x.png", "--view", "raw", "A=b", "s.json", "--quiet"})
        EXPECT_TRUE(has(merge, word)) << word;
    for (const char* word : {"a.obj", "--eye", "N", "--untrusted"})
        EXPECT_FALSE(has(merge, word)) << word;
    EXPECT_EQ(*givenValue(*options.farm, "--aov"), "Z");
    EXPECT_EQ(givenValue(*options.farm, "--crop"), nullptr);
}

// What is typed in other words is the same job.
TEST(FarmWords, HowAFarmWorksIsNotOfItsPlan) {
    const auto names = [](const Options& options) {
        Words words;
        for (const GivenOption& option : planOptions(*options.farm)) words.push_back(option.name);
        return words;
    };
    EXPECT_EQ(names(farmOf({"--tries", "5", "-v", "--size=8x8", "-o", "b.exr"})),
              names(farmOf({"--output", "b.exr", "--size", "8x8"})));
    EXPECT_NE(names(farmOf({"--size", "8x8"})), names(farmOf({})));
}

TEST(Frames, SequencesAreThoseOfOpenImageIo) {
    using Numbers = std::vector<std::int64_t>;
    const auto frames = [](const std::string& text) { return frameNumbers("--frames", text); };
    EXPECT_EQ(frames("7"), (Numbers{7}));
    EXPECT_EQ(frames("1-4"), (Numbers{1, 2, 3, 4}));
    EXPECT_EQ(frames("1-10x4"), (Numbers{1, 5, 9}));
    EXPECT_EQ(frames("1-4y2"), (Numbers{2, 4}));
    EXPECT_EQ(frames("3-1"), (Numbers{3, 2, 1}));
    EXPECT_EQ(frames("1-3,2-4,9"), (Numbers{1, 2, 3, 4, 9}));
    for (const char* text : {"", "a", "1-", "-1", "1-2x0", "1,,2", "1-3x", "1-2-3", " 1", "1.5",
                             "0-999999", "99999999999", "1-2,"})
        EXPECT_TRUE(refusesWith(refusal([&] { frames(text); }), 2, {"--frames", "1-10"})) << text;
}

TEST(Frames, EachHasACommandLineOfItsOwn) {
    const std::vector<Options> frames = perFrame(
        parsed({"s.%04d.obj", "--frames", "8-10x2", "-o", "o.####.exr", "--seed", "frame"}));
    ASSERT_EQ(frames.size(), 2u);
    EXPECT_EQ(frames[1].scene, "s.0010.obj");
    EXPECT_EQ(frames[1].outputs.at(0), "o.0010.exr");
    EXPECT_EQ(frames[0].settings.back().value, "8");
    EXPECT_EQ(perFrame(parsed({"s.obj"})).size(), 1u);
    EXPECT_TRUE(refusesWith(refusal([] {
                                perFrame(parsed({"s.##.obj", "--frames=1-2", "-o", "o.exr"}));
                            }),
                            2, {"o.exr", "frames 1 and 2", "####"}));
    EXPECT_TRUE(refusesWith(refusal([] {
                                parsed({"s.obj", "--frames", "1", "--frame", "1"});
                            }),
                            2, {"--frames and --frame"}));
}

}  // namespace
}  // namespace pm::host::test
