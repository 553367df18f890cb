// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// The command line: what it means, and what it refuses.
#include "host_shim/cli/command_line.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <locale>

#include "host_shim/cli/option_values.h"
#include "tests/ingest/heard.h"

namespace pm::host::test {
namespace {

using Arguments = std::vector<std::string>;

std::string refusal(Arguments arguments) {
    arguments.insert(arguments.begin(), "s.obj");
    return errorOf([&] { parseCommandLine(arguments); });
}

std::string setting(const Options& options, const std::string& name) {
    const auto found = std::ranges::find(options.settings, name, &GivenSetting::name);
    return found == options.settings.end() ? "none" : found->value;
}

TEST(CommandLine, defaults) {
    const Options options = parseCommandLine({"in/my box.obj"});
    EXPECT_EQ(options.scene, "in/my box.obj");
    ASSERT_EQ(options.outputs.size(), 1u);
    EXPECT_EQ(options.outputs[0], "my box.exr");
    EXPECT_EQ(options.width, 640);
    EXPECT_EQ(options.height, 480);
    EXPECT_TRUE(options.settings.empty());
    EXPECT_EQ(options.subdivide, Subdivide::kTagged);
}

TEST(CommandLine, values) {
    const Options options = parseCommandLine(
        {"-o",     "a.exr",     "-o",         "b c.png", "--eye", "-1,2.5,-3", "--size=32x16",
         "s.obj",  "--crop",    "-4,0,12,16", "--aa",    "2:2",   "--photons", "auto",
         "--seed", "frame",     "--frame",    "7",       "--aov", "albedo,N",  "--aov",
         "Z",      "--threads", "3",          "--fov",   "60.5",  "--context", "A=b=c"});
    EXPECT_EQ(options.outputs, (std::vector<std::filesystem::path>{"a.exr", "b c.png"}));
    EXPECT_EQ(*options.camera.eye, (std::array<double, 3>{-1, 2.5, -3}));
    EXPECT_EQ(options.width, 32);
    EXPECT_EQ(*options.crop, (PixelRect{-4, 0, 12, 16}));
    EXPECT_EQ(setting(options, "aaLevel"), "2");
    EXPECT_EQ(setting(options, "photons"), "0");
    EXPECT_EQ(setting(options, "seed"), "7");
    EXPECT_EQ(options.layers, "albedo,N,Z");
    EXPECT_EQ(options.threads, 3u);
    EXPECT_EQ(*options.camera.verticalFovDegrees, 60.5);
    EXPECT_EQ(options.colour.context[0].second, "b=c");
}

TEST(CommandLine, exposure) {
    using Kind = ExposureOption::Kind;
    EXPECT_EQ(parseCommandLine({"s.obj"}).exposure.kind, Kind::kNotGiven);
    EXPECT_TRUE(parseCommandLine({"s.obj"}).exposure.mayBeMeasured);
    EXPECT_EQ(parseCommandLine({"s.obj", "--exposure", "auto"}).exposure.kind, Kind::kAuto);
    const Options given = parseCommandLine({"s.obj", "--exposure", "-2.5"});
    EXPECT_EQ(given.exposure.kind, Kind::kStops);
    EXPECT_EQ(given.exposure.stops, -2.5);
    for (const Arguments& fixed :
         {Arguments{"s.obj", "--crop", "0,0,8,8"}, Arguments{"s.obj", "--frame", "3"},
          Arguments{"s.obj", "--buckets", "1/2", "-o", "p.pmpart"}})
        EXPECT_FALSE(parseCommandLine(fixed).exposure.mayBeMeasured) << fixed[1];
    EXPECT_EQ(
        parseCommandLine({"merge", "p.pmpart", "-o", "m.png", "--exposure", "1"}).exposure.stops,
        1);
    for (const char* wrong : {"20.5", "-21", "nan", "Auto", "1,5"})
        EXPECT_EQ(refusal({"--exposure", wrong}), "2 --exposure '" + std::string(wrong) +
                                                      "': a number in [-20, 20] or auto is wanted");
    EXPECT_EQ(parseCommandLine({"s.obj", "--camera-light", "off"}).cameraLight, CameraLight::kOff);
    EXPECT_TRUE(refusal({"--camera-light", "no"}).starts_with("2 --camera-light 'no': allowed"));
}

TEST(CommandLine, refusesWhatIsUnknownOrToCome) {
    EXPECT_TRUE(refusal({"--bogus"}).starts_with("2 "));
    EXPECT_TRUE(refusal({"another.obj"}).starts_with("2 "));
    EXPECT_TRUE(refusal({"-o"}).starts_with("2 "));
    EXPECT_TRUE(refusal({"--denoise", "x"}).starts_with("2 --denoise: not available yet; pm has"));
    EXPECT_TRUE(refusal({"--denoise=x"}).starts_with("2 --denoise: not available yet; pm has"));
}

TEST(CommandLine, levelsOfAntiAliasing) {
    const Options range = parseCommandLine({"s.obj", "--aa", "1:5", "--aa-threshold", "0.02"});
    EXPECT_EQ(setting(range, "aaLevel"), "1");
    EXPECT_EQ(setting(range, "aaLevelMost"), "5");
    EXPECT_EQ(setting(range, "aaThreshold"), "0.02");
    EXPECT_EQ(setting(parseCommandLine({"s.obj", "--aa=4"}), "aaLevelMost"), "4");
    const Options preview = parseCommandLine({"s.obj", "--aa", "0", "--filter", "gaussian"});
    EXPECT_EQ(setting(preview, "aaLevel"), "0");
    EXPECT_EQ(setting(preview, "aaLevelMost"), "0");
    EXPECT_EQ(setting(preview, "filter"), "gaussian");
    EXPECT_EQ(setting(parseCommandLine({"s.obj", "--aa", "0:3"}), "aaLevel"), "0");
}

TEST(CommandLine, photonMaps) {
    const Options read = parseCommandLine({"s.obj", "--photon-map", "m"});
    EXPECT_EQ(setting(read, "photonMap"), "m");
    EXPECT_EQ(read.outputs.size(), 1u);
    const Options only =
        parseCommandLine({"s.obj", "--photons-only", "--photon-map", "m.####", "--frame", "7"});
    EXPECT_EQ(setting(only, "photonMap"), "m.0007");
    EXPECT_EQ(setting(only, "photonsOnly"), "1");
    EXPECT_TRUE(only.outputs.empty());
    EXPECT_TRUE(refusal({"--photons-only"}).starts_with("2 --photons-only needs --photon-map"));
    for (const std::vector<std::string>& with :
         std::vector<std::vector<std::string>>{{"-o", "a.exr"},
                                               {"--reference", "r.exr"},
                                               {"--report", "r.html"},
                                               {"--only-pixel", "1,1"},
                                               {"--aov", "N"},
                                               {"--checkpoint", "c"},
                                               {"--buckets", "1/2"},
                                               {"--time-limit", "5"},
                                               {"--error-target", "1"}}) {
        std::vector<std::string> arguments = {"--photons-only", "--photon-map", "m"};
        arguments.insert(arguments.end(), with.begin(), with.end());
        const std::string text = refusal(arguments);
        EXPECT_TRUE(text.starts_with("2 --photons-only")) << text;
        EXPECT_NE(text.find(with.front()), std::string::npos) << text;
    }
}

TEST(CommandLine, bucketSizeAndOrder) {
    const Options options =
        parseCommandLine({"s.obj", "--bucket-size", "auto", "--bucket-order", "spiral"});
    EXPECT_EQ(setting(options, "bucketSize"), "0");
    EXPECT_EQ(setting(options, "bucketOrder"), "spiral");
    EXPECT_EQ(setting(parseCommandLine({"s.obj", "--bucket-size=64"}), "bucketSize"), "64");
}

TEST(CommandLine, refusesBadValues) {
    for (const Arguments& bad : std::vector<Arguments>{{"--size", "640"},
                                                       {"--size", "0x5"},
                                                       {"--size", "6,5x4"},
                                                       {"--eye", "1,2"},
                                                       {"--eye", "1,2,nan"},
                                                       {"--up", "0,0,0"},
                                                       {"--fov", "180"},
                                                       {"--fov", "0"},
                                                       {"--crop", "5,5,5,9"},
                                                       {"--aa", "7"},
                                                       {"--aa", "3:2"},
                                                       {"--frame", "x"},
                                                       {"--seed", "frame"},
                                                       {"--subdivide", "some"},
                                                       {"--progress", "loud"},
                                                       {"--list", "all"},
                                                       {"--context", "A"},
                                                       {"--error-limit", "0.1"},
                                                       {"-o", "a.####.exr"}}) {
        EXPECT_TRUE(refusal(bad).starts_with("2 ")) << bad[0] << " " << bad[1] << refusal(bad);
    }
}

// The line names the option, what was given and what is allowed.
TEST(CommandLine, refusalsSayWhatIsAllowed) {
    EXPECT_EQ(refusal({"--aa", "1:"}),
              "2 --aa '1:': N or MIN:MAX with 0 <= MIN <= MAX <= 6 is wanted");
    EXPECT_NE(refusal({"--aa", "3:2"}).find("'3:2': MIN is above MAX"), std::string::npos);
    for (const char* option : {"--photons", "--size", "--stats", "--reference", "--report"}) {
        const std::string text = refusal({option, ""});
        EXPECT_TRUE(text.starts_with("2 ") && text.find(option) != std::string::npos &&
                    text.find("empty") != std::string::npos)
            << text;
    }
}

// A forgotten value doesn't take the option that follows; numbers and OCIO's looks may begin with
// -.
TEST(CommandLine, anOptionIsNoValue) {
    for (const Arguments& bad : std::vector<Arguments>{{"--reference", "-o", "x.exr"},
                                                       {"-o", "--passes", "3"},
                                                       {"--aov", "-q"},
                                                       {"--ocio", "--view"}}) {
        const std::string text = refusal(bad);
        EXPECT_TRUE(text.starts_with("2 ") &&
                    text.find("its value is missing; '" + bad[1]) != std::string::npos)
            << text;
    }
    EXPECT_EQ(parseCommandLine({"s.obj", "--eye", "-1,-.5,0"}).camera.eye->at(0), -1);
    EXPECT_EQ(parseCommandLine({"s.obj", "--look", "-warm"}).colour.look, "-warm");
    EXPECT_EQ(parseCommandLine({"s.obj", "--stats", "-"}).statistics, "-");
}

TEST(CommandLine, sizesTellTheirRange) {
    for (const char* size : {"0x5", "65537x1", "1x65537", "99999999x2"})
        EXPECT_EQ(refusal({"--size", size}),
                  std::string("2 --size '") + size +
                      "': WIDTHxHEIGHT in whole pixels from 1 to 65536 is wanted, such as 640x480");
    EXPECT_EQ(parseCommandLine({"s.obj", "--size", "65536x1"}).width, 65536);
}

// Outside of the picture there is nothing, unless a crop asks for it.
TEST(CommandLine, onlyPixelIsInThePicture) {
    const auto parsed = [](const Arguments& more) {
        Arguments arguments{"s.obj", "--size", "64x48"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return errorOf([&] { parseCommandLine(arguments); });
    };
    for (const char* inside : {"0,0", "63,47"})
        EXPECT_EQ(parsed({"--only-pixel", inside}), "no error");
    for (const char* outside : {"64,47", "63,48", "-1,0", "0,-1"})
        EXPECT_EQ(parsed({std::string("--only-pixel=") + outside}),
                  std::string("2 --only-pixel '") + outside +
                      "': is outside the picture; X from 0 to 63 and Y from 0 to 47 are wanted, or "
                      "a --crop that holds it");
    EXPECT_EQ(parsed({"--only-pixel=-3,50", "--crop=-8,-8,72,56"}), "no error");
}

TEST(CommandLine, pieces) {
    const Options options =
        parseCommandLine({"s.obj", "-o", "a.%02d.pmpart", "--frame", "3", "--checkpoint", "c.##",
                          "--resume", "--buckets", "2/7"});
    EXPECT_TRUE(options.outputs.empty());
    EXPECT_EQ(options.part, "a.03.pmpart");
    EXPECT_EQ(setting(options, "part"), "a.03.pmpart");
    EXPECT_EQ(setting(options, "checkpoint"), "c.03");
    EXPECT_EQ(setting(options, "resume"), "1");
    EXPECT_EQ(setting(options, "buckets"), "2/7");
    EXPECT_FALSE(options.keepCheckpoint);
    EXPECT_TRUE(refusal({"--resume"}).starts_with("2 --resume needs --checkpoint"));
    EXPECT_TRUE(refusal({"--keep-checkpoint"}).starts_with("2 --keep-checkpoint needs"));
    EXPECT_TRUE(refusal({"--buckets", "1/2"}).starts_with("2 --buckets needs -o NAME.pmpart"));
    const Options merge = parseCommandLine(
        {"merge", "a.#.pmpart", "b.pmpart", "--frame", "4", "-o", "m.#.exr", "--view", "raw"});
    EXPECT_EQ(merge.merge, (std::vector<std::filesystem::path>{"a.4.pmpart", "b.pmpart"}));
    EXPECT_EQ(merge.outputs, (std::vector<std::filesystem::path>{"m.4.exr"}));
    EXPECT_EQ(merge.colour.view, "raw");
    const auto refusedMerge = [](const Arguments& arguments) {
        return errorOf([&] { parseCommandLine(arguments); });
    };
    EXPECT_TRUE(refusedMerge({"merge", "a"}).starts_with("2 usage: pm_host merge"));
    EXPECT_TRUE(refusedMerge({"merge", "-o", "b.exr"}).starts_with("2 usage: pm_host merge"));
    EXPECT_TRUE(refusedMerge({"merge", "a", "-o", "b.exr", "--passes", "3"}).starts_with("2 "));
    EXPECT_TRUE(refusedMerge({"merge", "a", "-o", "b.pmpart"}).starts_with("2 -o: merge makes"));
}

TEST(CommandLine, numbersHaveADotInAnyLocale) {
    const std::locale old = std::locale::global(std::locale(std::locale(), new CommaPoint));
    const Options options = parseCommandLine({"s.obj", "--fov", "60.5"});
    const std::string comma = refusal({"--fov", "60,5"});
    std::locale::global(old);
    EXPECT_EQ(*options.camera.verticalFovDegrees, 60.5);
    EXPECT_EQ(comma, "2 --fov '60,5': a number in [1e-06, 179.999999] is wanted");
}

TEST(CommandLine, helpNamesEveryOptionAndAsksThePlugin) {
    const std::string text = helpText([](const std::string& name) { return "about " + name; });
    for (const char* part : {"--output", "--bucket-order", "about bucketOrder", "--only-pixel"}) {
        EXPECT_NE(text.find(part), std::string::npos) << part;
    }
    EXPECT_NE(text.find("MIN: about MIN MAX: about MAX"), std::string::npos) << text;
    EXPECT_NE(text.find(mergeHelpText()), std::string::npos);
    EXPECT_NE(text.find(cacheHelpText()), std::string::npos);
    EXPECT_NE(text.find(checkHelpText()), std::string::npos);
    EXPECT_NE(text.find(farmHelpText()), std::string::npos);
    EXPECT_NE(text.find(packHelpText()), std::string::npos);
    EXPECT_TRUE(text.ends_with(watchHelpText()));
    EXPECT_EQ(mergeHelpText().find("SCENE"), std::string::npos) << mergeHelpText();
    EXPECT_TRUE(parseCommandLine({"merge", "-h"}).helpOfMerge);
    EXPECT_FALSE(parseCommandLine({"-h"}).helpOfMerge);
}

TEST(CommandLine, addressesAreScenes) {
    const auto output = [](const std::string& scene) {
        return parseCommandLine({scene}).outputs.at(0).string();
    };
    EXPECT_EQ(output("http://server:8000/shots/table/manifest.json"), "table.exr");
    EXPECT_EQ(output("https://server/table/manifest.json?key=a/b"), "table.exr");
    EXPECT_EQ(output("http://server:8000/manifest.json"), "picture.exr");
    EXPECT_EQ(output("http://server"), "picture.exr");
    EXPECT_EQ(output("file:///srv/packs/table/manifest.json"), "table.exr");
    EXPECT_EQ(output("http:/table/chair.obj"), "chair.exr") << "a file";
    // Escaped bytes are no patterns for frames.
    const std::string escaped = "http://server/%d0%91%20d/manifest.json";
    EXPECT_EQ(parseCommandLine({escaped}).scene.string(), escaped);
    EXPECT_EQ(parseCommandLine({"http://s/%20d.%04d/m.json", "--frame", "7"}).scene.string(),
              "http://s/%20d.0007/m.json");
    EXPECT_EQ(parseCommandLine({"s.obj", "--copies", "c", "--copies-limit", "0.5"}).copiesGib, 0.5);
    EXPECT_TRUE(refusal({"--copies-limit", "-1"}).starts_with("2 --copies-limit '-1'"));
}

TEST(CommandLine, packsAndWatchesWantWhatTheyNeed) {
    EXPECT_TRUE(parseCommandLine({"pack", "s.obj", "-o", "folder", "--aa", "2"}).pack);
    const Options watch = parseCommandLine({"watch", "parts", "-o", "p.exr", "--interval", "0.5"});
    EXPECT_EQ(watch.watch->intervalSeconds, 0.5);
    EXPECT_EQ(watch.merge, (std::vector<std::filesystem::path>{"parts"}));
    for (const std::vector<std::string>& words : std::vector<std::vector<std::string>>{
             {"pack", "s.obj"},
             {"pack", "-o", "folder"},
             {"pack", "s.obj", "-o", "a", "-o", "b"},
             {"pack", "s.obj", "-o", "a", "--frames", "1-2"},
             {"watch", "p.pmpart"},
             {"watch", "-o", "p.exr"},
             {"watch", "p.pmpart", "-o", "p.exr", "--page", "p.txt"}})
        EXPECT_TRUE(errorOf([&] { parseCommandLine(words); }).starts_with("2 "))
            << words[0] << " " << words[1];
}

TEST(CommandLine, checksHaveOptionsOfTheirOwn) {
    const auto checkOf = [](std::vector<std::string> words) {
        words.insert(words.begin(), {"check", "s.json"});
        return *parseCommandLine(words).check;
    };
    const CheckOptions plain = checkOf({});
    EXPECT_EQ(plain.suite, "s.json");
    EXPECT_EQ(plain.jobs, 1);
    EXPECT_TRUE(plain.only.empty());
    const CheckOptions all =
        checkOf({"--update", "--because", "why", "--seeds", "4", "--only", "a,b", "--only", "c",
                 "--jobs", "3", "--time-budget", "1.5", "--junit", "j.xml", "--html", "pages"});
    EXPECT_TRUE(all.update);
    EXPECT_EQ(all.because, "why");
    EXPECT_EQ(all.seeds, 4);
    EXPECT_EQ(all.only, (std::vector<std::string>{"a", "b", "c"}));
    EXPECT_EQ(all.jobs, 3);
    EXPECT_EQ(all.timeBudgetSeconds, 1.5);
    EXPECT_EQ(all.junit, "j.xml");
    EXPECT_EQ(all.html, "pages");
    for (const auto& [words, part] : std::vector<std::pair<std::vector<std::string>, std::string>>{
             {{"--update"}, "--because"},
             {{"--because", "why"}, "--update"},
             {{"--seeds", "4"}, "--update"},
             {{"--update", "--because", "why", "--seeds", "3"}, "4"},
             {{"--update", "--because", "why", "--seed", "3"}, "--seed"},
             {{"--jobs", "0"}, "--jobs"},
             {{"--size", "3x3"}, "--size"}}) {
        const std::string error = errorOf([&, &given = words] { checkOf(given); });
        EXPECT_TRUE(error.starts_with("2 ")) << error;
        EXPECT_NE(error.find(part), std::string::npos) << error;
    }
    EXPECT_TRUE(parseCommandLine({"check", "-h"}).helpOfCheck);
}

TEST(CommandLine, whatAScenesMaterialsAre) {
    const ReadRules usual = parseCommandLine({"a.obj"}).reading;
    EXPECT_EQ(usual.mtlDialect, "");
    EXPECT_TRUE(usual.files.isTrusted);
    EXPECT_TRUE(usual.files.searchPaths.empty());
    const ReadRules asked = parseCommandLine({"a.obj", "--mtl-dialect", "Blender4", "--search-path",
                                              "a b", "--untrusted", "--search-path", "c"})
                                .reading;
    EXPECT_EQ(asked.mtlDialect, "blender4");
    EXPECT_FALSE(parseCommandLine({"a.obj"}).bumpIsNormal);
    EXPECT_TRUE(parseCommandLine({"a.obj", "--bump-is-normal"}).bumpIsNormal);
    EXPECT_FALSE(asked.files.isTrusted);
    EXPECT_EQ(asked.files.searchPaths, (std::vector<std::filesystem::path>{"a b", "c"}));
    EXPECT_EQ(refusal({"--mtl-dialect", "blender"}),
              "2 --mtl-dialect 'blender': allowed are generic, blender2.7, blender2.8, blender3, "
              "blender4, 3dsmax, maya, rhino, sketchup, zbrush, mcguire");
}

TEST(CommandLine, SkiesAndEnvironments) {
    const Options sun = parseCommandLine({"a.obj", "--sun", "135,40", "--turbidity", "5"});
    ASSERT_TRUE(sun.sky.sun);
    EXPECT_EQ(*sun.sky.sun, (std::array<double, 2>{135, 40}));
    EXPECT_EQ(sun.sky.turbidity, 5);
    const Options picture =
        parseCommandLine({"a.obj", "--environment", "sky.exr", "--environment-rotation", "90",
                          "--environment-strength", "0.5"});
    EXPECT_EQ(picture.sky.environment, "sky.exr");
    EXPECT_EQ(picture.sky.rotation, 90);
    EXPECT_EQ(picture.sky.strength, 0.5);
    for (const char* wrong : {"135", "135,0", "135,91", "a,b", "400,40", "1,2,3"})
        EXPECT_TRUE(refusal({"--sun", wrong}).starts_with("2 --sun")) << wrong;
    EXPECT_EQ(refusal({"--turbidity", "3"}), "2 --turbidity needs --sun");
    EXPECT_EQ(refusal({"--environment-rotation", "3"}),
              "2 --environment-rotation needs --environment");
    EXPECT_TRUE(refusal({"--sun", "1,2", "--environment", "a.exr"}).starts_with("2 --sun makes"));
}

}  // namespace
}  // namespace pm::host::test
