// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Words of the command line that are none: verbs that are mistyped, and options of other renderers.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "host_shim/cli/command_line.h"
#include "host_shim/values/host_error.h"

namespace pm::host {
namespace {

using Words = std::vector<std::string>;

std::string refusalOf(const Words& words) {
    try {
        static_cast<void>(parseCommandLine(words));
    } catch (const HostError& error) {
        EXPECT_EQ(error.code(), ExitCode::kUsage) << error.what();
        return error.what();
    }
    return "taken";
}

void expectSays(const Words& words, const std::string& text) {
    EXPECT_NE(refusalOf(words).find(text), std::string::npos)
        << words.front() << " .. " << words.back() << ": " << refusalOf(words)
        << "\nwanted: " << text;
}

TEST(Words, mistypedVerbsNameTheVerbs) {
    const std::string verbs = "verbs are cache, check, farm, merge, pack and watch";
    for (const auto& [words, meant] : std::vector<std::pair<Words, std::string>>{
             {{"chek", "suite.json"}, "pm_host check"},
             {{"chek", "suite.json", "--update", "--because", "x"}, "pm_host check"},
             {{"chek"}, "pm_host check"},
             {{"rendr", "x.obj"}, "pm_host SCENE [options]"},
             {{"render", "x.obj", "-o", "a.png"}, "pm_host SCENE [options]"},
             {{"Merge", "a.pmpart", "b.pmpart", "-o", "x.exr"}, "pm_host merge"},
             {{"chache", "--list"}, "pm_host cache"},
             {{"wacth", "parts", "-o", "x.exr"}, "pm_host watch"},
             {{"help"}, "pm_host -h"}}) {
        expectSays(words,
                   "'" + words.front() + "': there is no such verb; is " + meant + " meant?");
        expectSays(words, verbs);
    }
    expectSays({"convert", "x.obj"}, "'convert': there is no such verb; verbs are");
    expectSays({"-q", "check", "suite.json"}, "'check': a verb is the first word");
}

TEST(Words, namesOfScenesAreNoVerbs) {
    EXPECT_EQ(refusalOf({"teapot"}), "taken");
    EXPECT_EQ(refusalOf({"chek.obj"}), "taken");
    EXPECT_EQ(refusalOf({"./chek"}), "taken");
    expectSays({"a.obj", "b.obj"}, "'b.obj': one scene is wanted");
    expectSays({"a.obj", "check", "b.obj"}, "'check b.obj': one scene is wanted");
}

TEST(Words, optionsOfOthersGetTheOneThatIsMeant) {
    for (const auto& [word, answer] : std::vector<std::pair<std::string, std::string>>{
             {"--spp", "--passes N, and in each of them --aa"},
             {"--samples", "--passes N, and in each of them --aa"},
             {"-s", "--passes N"},
             {"--cycles-device", "pm has none: it renders on processors"},
             {"--gpu", "pm has none"},
             {"--resolution", "--size WxH"},
             {"+W640", "--size WxH"},
             {"+H480", "--size WxH"},
             {"+Oout.png", "-o FILE"},
             {"-t", "--threads N"},
             {"-t8", "--threads N"},
             {"--nthreads", "--threads N"},
             {"--aperture", "pm has none: its camera is a pinhole"},
             {"--focus-distance", "pm has none: its camera is a pinhole"},
             {"--motion-blur", "pm has none: a picture is of one moment"},
             {"--depth", "pm has none: light is followed"},
             {"--max_depth", "pm has none: light is followed"},
             {"--gamma", "--view NAME"},
             {"--hdri", "--environment FILE"},
             {"--fps", "pm has none: it renders frames"},
             {"--outfile", "-o FILE"},
             {"--cropwindow", "--crop x0,y0,x1,y1"},
             {"--lookAt", "is --look-at meant?"},
             {"--bucket_size", "is --bucket-size meant?"},
             {"--env", "--environment FILE"},
             {"--turb", "is --turbidity meant?"}}) {
        expectSays({"s.obj", word, "1"}, "there is no such option; ");
        expectSays({"s.obj", word, "1"}, answer);
        expectSays({word, "1", "s.obj"}, answer);
    }
    expectSays({"s.obj", "--denoise"}, "--denoise: not available yet; pm has none");
    EXPECT_EQ(refusalOf({"s.obj", "--bogus"}), "--bogus: there is no such option (see pm_host -h)");
}

TEST(Words, eachUnknownOptionIsAnswered) {
    const Words words{"s.obj", "--width", "640", "--height", "480", "--gpu=0"};
    expectSays(words, "--width, --height: there is no such option; --size WxH is meant; --gpu: ");
    expectSays({"s.obj", "samples=64"}, "samples: there is no such option");
}

// "-output x.exr" would write the file "utput".
TEST(Words, oneDashInPlaceOfTwo) {
    expectSays({"s.obj", "-output", "x.exr"},
               "-output: there is no such option; is --output meant?");
    expectSays({"-threads", "4", "s.obj"},
               "-threads: there is no such option; is --threads meant?");
    expectSays({"s.obj", "-spp=64"}, "-spp: there is no such option; samples of a pixel");
    EXPECT_EQ(refusalOf({"s.obj", "-ox.exr", "--eye", "-1,0,-5", "--exposure", "-2.5"}), "taken");
    EXPECT_EQ(refusalOf({"s.obj", "--threads=4", "--output=x.exr"}), "taken");
}

}  // namespace
}  // namespace pm::host
