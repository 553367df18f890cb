// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include <cmath>

#include "host_shim/colour/colour_pipeline.h"
#include "tests/colour/scratch.h"
#include "tests/colour/stored_ramps.h"

namespace pm::host::test {
namespace {

class Spaces : public ScratchTest {};

ColourPipeline inSpace(const std::string& space) {
    return ColourPipeline({.renderingSpace = space});
}

void expectNear(const Rgb3& actual, const std::array<double, 3>& expected, double tolerance) {
    for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(actual[c], expected[c], tolerance) << c;
}

// Published figures: Rec.709 of IEC 61966-2-1 (four digits), AP1 of Academy S-2014-004, the latter
// adapted to D65 by hand.
TEST_F(Spaces, MatricesToXyz) {
    const Matrix3 rec709 = *inSpace("lin_rec709_scene").renderingToXyzD65();
    const Matrix3 published{0.4124, 0.3576, 0.1805, 0.2126, 0.7152, 0.0722, 0.0193, 0.1192, 0.9505};
    for (std::size_t i = 0; i < 9; ++i) EXPECT_NEAR(rec709[i], published[i], 6e-5) << i;
    // Every space's white is D65, and its luminance weights sum to 1.
    for (const char* space : {"lin_rec709_scene", "lin_ap1_scene", "lin_ap0_scene"}) {
        const ColourPipeline colour = inSpace(space);
        const Matrix3 m = *colour.renderingToXyzD65();
        EXPECT_NEAR(m[0] + m[1] + m[2], 0.3127 / 0.3290, 1e-5) << space;
        EXPECT_NEAR(m[3] + m[4] + m[5], 1.0, 1e-5) << space;
        EXPECT_NEAR(m[6] + m[7] + m[8], (1 - 0.3127 - 0.3290) / 0.3290, 1e-5) << space;
        const auto weights = colour.luminanceWeights();
        EXPECT_EQ(weights[0] + weights[1] + weights[2], m[3] + m[4] + m[5]);
    }
}

TEST_F(Spaces, InteropIdsAndChromaticities) {
    const auto ids = [](const char* space) { return inSpace(space).colorInteropId(); };
    EXPECT_EQ(ids("Linear Rec.709"), "lin_rec709_scene");
    EXPECT_EQ(ids("ACEScg"), "lin_ap1_scene");
    EXPECT_EQ(ids("ACES2065-1"), "lin_ap0_scene");
    EXPECT_EQ(
        *inSpace("ACEScg").chromaticities(),
        (std::array<float, 8>{0.713f, 0.293f, 0.165f, 0.83f, 0.128f, 0.044f, 0.32168f, 0.33767f}));
    EXPECT_EQ(*inSpace("Linear Rec.709").chromaticities(),
              (std::array<float, 8>{0.64f, 0.33f, 0.3f, 0.6f, 0.15f, 0.06f, 0.3127f, 0.329f}));
}

TEST_F(Spaces, MaterialColoursAreLinearRec709) {
    // Rec.709 red in AP1, Bradford-adapted: Academy's published matrix.
    expectNear(inSpace("ACEScg").materialToRendering({1, 0, 0}), {0.613097, 0.070194, 0.020616},
               2e-6);
    expectNear(inSpace("ACEScg").materialToRendering({0.5f, 0.5f, 0.5f}), {0.5, 0.5, 0.5}, 1e-6);
    EXPECT_EQ(ColourPipeline{ColourOptions{}}.materialToRendering({0.1f, -2, 1e4f}),
              (Rgb3{0.1f, -2, 1e4f}));
    const ColourPipeline srgb({.materialSpace = "srgb_tx"});
    expectNear(srgb.materialToRendering({0.461356f, 1, 0}), {0.18, 1, 0}, 2e-6);
    const ColourPipeline acescg({.materialSpace = "acescg"});
    expectNear(acescg.materialToRendering({0.613097f, 0.070194f, 0.020616f}), {1, 0, 0}, 2e-5);
}

TEST_F(Spaces, AliasesAreTheInteropIds) {
    const ColourPipeline colour{ColourOptions{}};
    for (const char* id :
         {"lin_rec709_scene", "lin_ap1_scene", "lin_ap0_scene", "srgb_rec709_scene", "srgb_tx",
          "data", "raw", "srgb_rec709_display", "g24_rec709_display"}) {
        EXPECT_NO_THROW(colour.textureSpace("a.png", false, id)) << id;
    }
}

TEST_F(Spaces, GreysAgreeBetweenConfigs) {
    if (!std::filesystem::exists(std::string(PM_SHARED_DATA) + kCgConfig)) {
        GTEST_SKIP() << "needs " << PM_SHARED_DATA << kCgConfig;
    }
    const ColourPipeline user({.ocioFile = std::string(PM_SHARED_DATA) + kCgConfig});
    const ColourPipeline own = inSpace("ACEScg");
    EXPECT_EQ(user.renderingSpace(), "ACEScg");
    EXPECT_EQ(user.colorInteropId(), "lin_ap1_scene");
    for (const Rgb3 colour : {Rgb3{0.18f, 0.18f, 0.18f}, Rgb3{1, 0, 0}, Rgb3{-0.5f, 0.2f, 30}}) {
        const Rgb3 expected = own.materialToRendering(colour);
        expectNear(user.materialToRendering(colour), {expected[0], expected[1], expected[2]}, 1e-5);
    }
    for (const char* space : {"Linear Rec.2020", "Linear P3-D65", "Linear Rec.709 (sRGB)"}) {
        const ColourPipeline colour(
            {.ocioFile = std::string(PM_SHARED_DATA) + kCgConfig, .renderingSpace = space});
        expectNear(colour.materialToRendering({0.18f, 0.18f, 0.18f}), {0.18, 0.18, 0.18}, 2e-6);
        EXPECT_TRUE(colour.colorInteropId().starts_with("lin_")) << space;
    }
}

TEST_F(Spaces, TextureSpaceIsDecidedInOrder) {
    const ColourPipeline plain{ColourOptions{}};
    const auto decided = [](const ColourPipeline& colour, const char* name, bool isFloat,
                            const char* line) {
        const TextureSpace space = colour.textureSpace(name, isFloat, line);
        return space.name + "|" + space.decidedBy + (space.isData ? "|data" : "");
    };
    EXPECT_EQ(decided(plain, "a.png", false, ""), "sRGB texture|default");
    EXPECT_EQ(decided(plain, "a.exr", true, ""), "Linear Rec.709|default");
    EXPECT_EQ(decided(plain, "a.png", false, "lin_ap1"), "ACEScg|-colorspace");
    EXPECT_EQ(decided(plain, "a.png", false, "data"), "raw|-colorspace|data");
    const ColourPipeline forced({.textureSpace = "acescg"});
    EXPECT_EQ(decided(forced, "a.png", false, ""), "ACEScg|--texture-space");
    EXPECT_EQ(decided(forced, "a.png", false, "sRGB"), "sRGB texture|-colorspace");
    EXPECT_TRUE(refusesWith(refusal([&] { plain.textureSpace("a.png", false, "nope"); }), 3,
                            {"-colorspace", "'nope'", "'ACEScg'"}));
    if (!std::filesystem::exists(std::string(PM_SHARED_DATA) + kDemo)) {
        GTEST_SKIP() << "the rest needs " << PM_SHARED_DATA << kDemo;
    }
    const ColourPipeline demo({.ocioFile = std::string(PM_SHARED_DATA) + kDemo});
    EXPECT_EQ(decided(demo, "x_LogC.png", false, ""), "ARRI LogC|file rules");
    EXPECT_EQ(decided(demo, "x.tx", false, ""), "Raw|file rules|data");
    EXPECT_EQ(decided(demo, "x.png", false, ""), "sRGB texture|default");
    EXPECT_EQ(decided(demo, "x_LogC.png", false, "acescct"), "ACEScct|-colorspace");
}

}  // namespace
}  // namespace pm::host::test
