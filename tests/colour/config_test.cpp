// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include <clocale>
#include <cmath>
#include <cstdlib>

#include "host_shim/colour/colour_pipeline.h"
#include "tests/colour/scratch.h"
#include "tests/colour/stored_ramps.h"

namespace pm::host::test {
namespace {

// A small config whose only linear space is "lin" and that has no interchange role.
constexpr const char* kSmallConfig = R"(ocio_profile_version: 2
roles: {scene_linear: lin, default: lin}
file_rules:
  - !<Rule> {name: logs, colorspace: curve, pattern: "*_log*", extension: "*"}
  - !<Rule> {name: Default, colorspace: default}
displays:
  screen:
    - !<View> {name: plain, colorspace: lin}
    - !<View> {name: curved, colorspace: curve}
looks:
  - !<Look> {name: half, process_space: lin, transform: !<MatrixTransform> {matrix: [0.5,0,0,0, 0,0.5,0,0, 0,0,0.5,0, 0,0,0,1]}}
colorspaces:
  - !<ColorSpace> {name: lin, isdata: false}
  - !<ColorSpace> {name: curve, isdata: false, to_reference: !<ExponentTransform> {value: [2, 2, 2, 1]}}
  - !<ColorSpace> {name: offset, isdata: false, to_reference: !<MatrixTransform> {offset: [0.1, 0, 0, 0]}}
  - !<ColorSpace> {name: vectors, isdata: true}
)";

class Config : public ScratchTest {
  protected:
    ColourOptions small() {
        writeBytes(file("small.ocio"), kSmallConfig);
        ColourOptions options;
        options.ocioFile = file("small.ocio").string();
        options.materialSpace = "lin";
        return options;
    }
    static std::string refused(const ColourOptions& options) {
        return refusal([&] { ColourPipeline{options}; });
    }
};

TEST_F(Config, TheBuiltInOneIsTheDefault) {
    const ColourPipeline colour{ColourOptions{}};
    EXPECT_EQ(colour.configName(), "built-in");
    EXPECT_EQ(colour.renderingSpace(), "Linear Rec.709");
    EXPECT_EQ(colour.display(), "sRGB");
    EXPECT_EQ(colour.view(), "ACES SDR");
    EXPECT_TRUE(colour.warnings().empty());
    EXPECT_EQ(colour.cacheId(), ColourPipeline{ColourOptions{}}.cacheId());
}

TEST_F(Config, OptionThenVariableThenBuiltIn) {
    const ColourOptions options = small();
    writeBytes(file("other.ocio"), std::string(kSmallConfig) + "name: other\n");
    setenv("OCIO", file("other.ocio").c_str(), 1);
    EXPECT_EQ(ColourPipeline(options).configName(), options.ocioFile);
    ColourOptions byVariable = options;
    byVariable.ocioFile.clear();
    EXPECT_EQ(ColourPipeline(byVariable).configName(), file("other.ocio").string());
    EXPECT_NE(ColourPipeline(byVariable).cacheId(), ColourPipeline(options).cacheId());
    setenv("OCIO", "", 1);
    EXPECT_EQ(ColourPipeline(ColourOptions{}).configName(), "built-in");
    setenv("OCIO", "/no/such.ocio", 1);
    EXPECT_TRUE(refusesWith(refused({}), 3, {"$OCIO", "/no/such.ocio", "does not exist"}));
    unsetenv("OCIO");
    EXPECT_EQ(ColourPipeline(ColourOptions{}).configName(), "built-in");
}

TEST_F(Config, BadConfigsAreRefused) {
    ColourOptions options;
    options.ocioFile = "/no/such.ocio";
    EXPECT_TRUE(refusesWith(refused(options), 3, {"--ocio", "/no/such.ocio"}));
    options.ocioFile = folder().string();
    EXPECT_TRUE(refusesWith(refused(options), 3, {"--ocio", options.ocioFile}));
    options.ocioFile = file("x.ocio").string();
    writeBytes(options.ocioFile, "no: [config");
    EXPECT_TRUE(refusesWith(refused(options), 3, {"--ocio", "x.ocio"}));
    for (const char* version : {"2.2", "2.3", "3", "\"2.4\""}) {
        writeBytes(options.ocioFile,
                   "# a comment\n" + ("ocio_profile_version: " + std::string(version)) + "\n");
        EXPECT_TRUE(refusesWith(refused(options), 3, {"x.ocio:2:", "ocio_profile_version", "2.1"}))
            << version;
    }
    EXPECT_TRUE(refusesWith(refusal([] { parseContextVariable("SHOT"); }), 2, {"KEY=VALUE"}));
    EXPECT_TRUE(refusesWith(refusal([] { parseContextVariable("=x"); }), 2, {"KEY=VALUE"}));
    EXPECT_EQ(parseContextVariable("A=b=c"), (std::pair<std::string, std::string>("A", "b=c")));
}

TEST_F(Config, UnknownNamesListWhatIsAllowed) {
    EXPECT_TRUE(refusesWith(refused({.display = "x"}), 3, {"--display", "'x'", "'Rec.1886'"}));
    EXPECT_TRUE(refusesWith(refused({.view = "x"}), 3, {"--view", "'x'", "'untone-mapped'"}));
    EXPECT_TRUE(refusesWith(refused({.look = "x"}), 3, {"--look", "'x'", "none"}));
    EXPECT_TRUE(refusesWith(refused({.materialSpace = "x"}), 3, {"--material-space", "'ACEScg'"}));
    EXPECT_TRUE(refusesWith(refused({.textureSpace = "x"}), 3, {"--texture-space", "'raw'"}));
    EXPECT_TRUE(refusesWith(refused({.renderingSpace = "x"}), 3, {"--rendering-space", "'x'"}));
    ColourOptions options = small();
    options.look = "+half, -none";
    EXPECT_TRUE(refusesWith(refused(options), 3, {"--look", "'none'", "'half'"}));
}

TEST_F(Config, OnlySceneLinearSpacesRender) {
    for (const char* space : {"raw", "data"}) {
        EXPECT_TRUE(refusesWith(refused({.renderingSpace = space}), 3,
                                {"--rendering-space", "is data", "'ACEScg'"}));
    }
    for (const char* space : {"sRGB texture", "srgb_display"}) {
        EXPECT_TRUE(refusesWith(refused({.renderingSpace = space}), 3,
                                {"--rendering-space", "not scene-linear", "'ACEScg'"}));
    }
    ColourOptions options = small();
    for (const char* space : {"curve", "offset", "vectors"}) {
        options.renderingSpace = space;
        EXPECT_TRUE(refusesWith(refused(options), 3, {space, "'lin'"}));
    }
    options = small();
    std::string text = kSmallConfig;
    text.replace(text.find("scene_linear: lin, "), 19, "");
    writeBytes(options.ocioFile, text);
    EXPECT_TRUE(refusesWith(refused(options), 3, {"--rendering-space", "scene_linear", "'lin'"}));
    options.renderingSpace = "lin";
    EXPECT_EQ(ColourPipeline(options).renderingSpace(), "lin");
}

TEST_F(Config, WithoutInterchangeRoleTheBuiltInNamesCannotBeReached) {
    ColourOptions options = small();
    options.materialSpace.clear();
    EXPECT_TRUE(refusesWith(refused(options), 3,
                            {"--material-space", "aces_interchange", "small.ocio", "'lin'"}));
    options.materialSpace = "ACEScg";
    EXPECT_TRUE(refusesWith(refused(options), 3, {"--material-space", "aces_interchange"}));
    options.materialSpace = "vectors";  // data is taken as it is
    EXPECT_EQ(ColourPipeline(options).materialToRendering({1, 2, 3}), (Rgb3{1, 2, 3}));
    options.materialSpace = "curve";
    const ColourPipeline colour(options);
    EXPECT_NEAR(colour.materialToRendering({0.5f, 0, 0})[0], 0.25f, 1e-6f);
    EXPECT_FALSE(colour.renderingToXyzD65());
    EXPECT_FALSE(colour.chromaticities());
    EXPECT_EQ(colour.luminanceWeights()[1], 0.7152);
    ASSERT_EQ(colour.warnings().size(), 1u);
    EXPECT_NE(colour.warnings()[0].find("aces_interchange"), std::string::npos);
    EXPECT_TRUE(refusesWith(
        refusal([&] { colour.textureToRendering(colour.textureSpace("a.png", false, "")); }), 3,
        {"--texture-space", "aces_interchange"}));
}

TEST_F(Config, LooksAreApplied) {
    ColourOptions options = small();
    std::array<float, 3> values{0.5f, 0.25f, 1.0f};
    ColourPipeline(options).displayTransform().apply(values, 3);
    EXPECT_FLOAT_EQ(values[0], 0.5f);
    options.look = "half";
    ColourPipeline(options).displayTransform().apply(values, 3);
    EXPECT_FLOAT_EQ(values[0], 0.25f);
    options.look = "-half";
    ColourPipeline(options).displayTransform().apply(values, 3);
    EXPECT_FLOAT_EQ(values[0], 0.5f);
    options.view = "CURVED";
    options.look = "";
    EXPECT_EQ(ColourPipeline(options).view(), "curved");
    ColourPipeline(options).displayTransform().apply(values, 3);
    EXPECT_NEAR(values[0], std::sqrt(0.5f), 1e-6f);
}

TEST_F(Config, ContextThatTheConfigDoesNotKnowIsSaid) {
    const ColourPipeline colour({.context = {{"SHTO", "1"}}});
    ASSERT_EQ(colour.warnings().size(), 1u);
    EXPECT_NE(colour.warnings()[0].find("SHTO"), std::string::npos);
}

TEST_F(Config, ListsSayWhatIsThere) {
    const ColourPipeline colour{ColourOptions{}};
    const auto views = colour.listViews();
    ASSERT_EQ(views.size(), 6u);
    EXPECT_EQ(views[0].display + "|" + views[0].view, "sRGB|ACES SDR");
    EXPECT_TRUE(views[0].isDefault);
    EXPECT_EQ(views[5].display + "|" + views[5].view, "Rec.1886|raw");
    EXPECT_FALSE(views[5].isDefault);
    std::string canRender;
    for (const SpaceEntry& space : colour.listSpaces()) {
        if (space.canRender) canRender += space.name + (space.isRenderingSpace ? "*|" : "|");
        EXPECT_EQ(space.isData, space.name == "raw") << space.name;
    }
    EXPECT_EQ(canRender, "Linear Rec.709*|ACEScg|ACES2065-1|");
    EXPECT_EQ(ColourPipeline(small()).listSpaces().size(), 4u + 7u);
}

TEST_F(Config, ACommaLocaleChangesNothing) {
    const std::string before = ColourPipeline{ColourOptions{}}.cacheId();
    const char* found = nullptr;
    for (const char* name : {"de_DE.UTF-8", "de_DE.utf8", "fr_FR.UTF-8", "fr_FR.utf8"}) {
        if (found == nullptr) found = std::setlocale(LC_ALL, name);
    }
    if (found == nullptr) GTEST_SKIP() << "no locale with a comma is installed";
    const ColourPipeline colour{ColourOptions{}};
    EXPECT_EQ(colour.cacheId(), before);
    std::array<float, 3> values{0.18f, 0.18f, 0.18f};
    colour.displayTransform().apply(values, 3);
    EXPECT_NEAR(values[0], 0.3559543f, 2e-5f);
    std::setlocale(LC_ALL, "C");
}

TEST_F(Config, TheNewerCgConfigIsRefusedWithItsVersionLine) {
    const std::string path =
        PM_SHARED_DATA "/ocio/builtin/cg-config-v2.1.0_aces-v1.3_ocio-v2.3.ocio";
    if (!std::filesystem::exists(path)) GTEST_SKIP() << "needs " << path;
    EXPECT_TRUE(refusesWith(refused({.ocioFile = path}), 3,
                            {path + ":1:", "ocio_profile_version: 2.3", "2.1"}));
}

}  // namespace
}  // namespace pm::host::test
