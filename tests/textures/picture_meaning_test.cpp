// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// What the channels, windows, layers and statements of a picture mean for a texture.
#include <array>
#include <cmath>
#include <fstream>
#include <functional>
#include <limits>

#include "tests/textures/texture_support.h"

namespace pm::host::test {
namespace {

using OIIO::TypeDesc;
using Vector = std::array<float, 3>;

class PictureMeaning : public TextureTest {
  protected:
    float mask(const std::string& name) const {
        const auto values = texels({file(name), TextureKind::kMask, "", 0});
        return values.empty() ? -1 : values[0];
    }
    // A picture of one texel, each channel with its name.
    void writeNamed(const std::string& name, const std::vector<std::string>& channels,
                    const std::vector<float>& values) const {
        OIIO::ImageSpec spec(1, 1, static_cast<int>(channels.size()), TypeDesc::FLOAT);
        spec.channelnames = channels;
        writePicture(file(name), spec, values);
    }
    void expectTexel(const std::string& name, std::array<float, 3> expected,
                     float tolerance = 1e-6f) const {
        const auto values = texels({file(name)});
        ASSERT_EQ(values.size(), 3u) << name;
        for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(values[c], expected[c], tolerance) << name;
    }
};

TEST_F(PictureMeaning, MaskIsAlphaWhereThereIsOne) {
    for (const char* format : {"png", "tif"}) {
        const std::string end = std::string(".") + format;
        writeTexture(file("opaque" + end), 1, 1, 4, TypeDesc::UINT8, {0.1f, 0.6f, 0.2f, 1});
        writeTexture(file("clear" + end), 1, 1, 4, TypeDesc::UINT8, {0.1f, 0.6f, 0.2f, 0});
        writeTexture(file("deep" + end), 1, 1, 4, TypeDesc::UINT16, {0.1f, 0.6f, 0.2f, 0.3f});
        writeTexture(file("grey_alpha" + end), 1, 1, 2, TypeDesc::UINT8, {1, 64.0f / 255});
        writeTexture(file("grey" + end), 1, 1, 1, TypeDesc::UINT8, {64.0f / 255});
        EXPECT_FLOAT_EQ(mask("opaque" + end), 1) << format;
        EXPECT_FLOAT_EQ(mask("clear" + end), 0) << format;
        EXPECT_NEAR(mask("deep" + end), 0.3f, 1e-5f) << format;
        EXPECT_FLOAT_EQ(mask("grey_alpha" + end), 64.0f / 255) << format;
        EXPECT_FLOAT_EQ(mask("grey" + end), 64.0f / 255) << format;
    }
    writeNamed("leaf.exr", {"R", "G", "B", "A"}, {0.1f, 0.2f, 0, 0.25f});
    EXPECT_FLOAT_EQ(mask("leaf.exr"), 0.25f);
}

TEST_F(PictureMeaning, MaskOfAColourPictureIsItsLuminance) {
    writeTexture(file("colour.png"), 1, 1, 3, TypeDesc::UINT8, {1, 0, 0});
    EXPECT_NEAR(mask("colour.png"), 0.2126f, 1e-4f);
    writeTexture(file("grey.png"), 1, 1, 3, TypeDesc::UINT8, {0.2f, 0.2f, 0.2f});
    EXPECT_FLOAT_EQ(mask("grey.png"), 51.0f / 255);
}

TEST_F(PictureMeaning, AChannelCanBeAskedFor) {
    writeTexture(file("four.png"), 1, 1, 4, TypeDesc::UINT8, {0.2f, 0.4f, 0.6f, 0.8f});
    const auto number = [&](char channel) {
        return texels({file("four.png"), TextureKind::kMask, "", channel})[0];
    };
    EXPECT_NEAR(number('r'), 0.2f, 1e-3f);
    EXPECT_NEAR(number('g'), 0.4f, 1e-3f);
    EXPECT_NEAR(number('b'), 0.6f, 1e-3f);
    EXPECT_NEAR(number('m'), 0.8f, 1e-3f);
    EXPECT_NEAR(number('l'), 0.2126f * 0.2f + 0.7152f * 0.4f + 0.0722f * 0.6f, 1e-3f);
    writeTexture(file("three.png"), 1, 1, 3, TypeDesc::UINT8, {0.2f, 0.4f, 0.6f});
    EXPECT_NE(baked({file("three.png"), TextureKind::kMask, "", 'm'}).facts.note, "");
}

// A picture of 8 x 4 in which red is the column and green the row, of which some part is stored.
class Window : public PictureMeaning {
  protected:
    std::vector<float> baked8x4(int x0, int y0, int x1, int y1, const std::string& name) const {
        OIIO::ImageSpec spec(x1 - x0, y1 - y0, 3, TypeDesc::FLOAT);
        spec.x = x0;
        spec.y = y0;
        spec.full_width = 8;
        spec.full_height = 4;
        std::vector<float> values;
        for (int y = y0; y < y1; ++y)
            for (int x = x0; x < x1; ++x)
                values.insert(values.end(), {static_cast<float>(std::max(x, 0)),
                                             static_cast<float>(std::max(y, 0)), 1});
        writePicture(file(name), spec, values);
        const BakedTexture texture = baked({file(name), TextureKind::kColour, "raw"});
        EXPECT_EQ(texture.facts.width, 8);
        EXPECT_EQ(texture.facts.height, 4);
        return readLevels(texture.file)[0].values;
    }
    static void expectWindow(const std::vector<float>& values, int x0, int y0, int x1, int y1) {
        ASSERT_EQ(values.size(), 96u);
        for (int y = 0; y < 4; ++y)
            for (int x = 0; x < 8; ++x) {
                const float* texel = &values[static_cast<std::size_t>(y * 8 + x) * 3];
                const bool isIn = x >= x0 && x < x1 && y >= y0 && y < y1;
                EXPECT_EQ(texel[0], isIn ? static_cast<float>(x) : 0.0f) << x << " " << y;
                EXPECT_EQ(texel[1], isIn ? static_cast<float>(y) : 0.0f) << x << " " << y;
                EXPECT_EQ(texel[2], isIn ? 1.0f : 0.0f) << x << " " << y;
            }
    }
};

TEST_F(Window, DataMayBeSmallerLargerAndBeside) {
    expectWindow(baked8x4(4, 0, 8, 4, "right.exr"), 4, 0, 8, 4);
    expectWindow(baked8x4(-3, -2, 11, 9, "over.exr"), -3, -2, 11, 9);
    expectWindow(baked8x4(2, 1, 5, 3, "inner.exr"), 2, 1, 5, 3);
    expectWindow(baked8x4(-2, 2, 3, 7, "corner.exr"), -2, 2, 3, 7);
    expectWindow(baked8x4(20, 20, 24, 24, "beside.exr"), 20, 20, 24, 24);
    expectWindow(baked8x4(4, 1, 8, 4, "right.tif"), 4, 1, 8, 4);
}

TEST_F(Window, OffsetsOfOtherFilesAreNoWindows) {
    OIIO::ImageSpec spec(2, 1, 3, TypeDesc::UINT8);
    spec.x = 5;
    spec.y = 7;
    writePicture(file("moved.png"), spec, {1, 1, 1, 0, 0, 0});
    EXPECT_EQ(texels({file("moved.png"), TextureKind::kColour, "raw"}),
              (std::vector<float>{1, 1, 1, 0, 0, 0}));
}

TEST_F(PictureMeaning, LayersAreChosenByName) {
    writeNamed("blender.exr",
               {"ViewLayer.AO.R", "ViewLayer.AO.G", "ViewLayer.AO.B", "ViewLayer.Combined.R",
                "ViewLayer.Combined.G", "ViewLayer.Combined.B"},
               {1, 1, 1, 0.25f, 0.5f, 0.75f});
    expectTexel("blender.exr", {0.25f, 0.5f, 0.75f});
    const std::string note = baked({file("blender.exr")}).facts.note;
    EXPECT_NE(note.find("'ViewLayer.Combined'"), std::string::npos) << note;
    EXPECT_NE(note.find("'ViewLayer.AO'"), std::string::npos) << note;
    writeNamed("nuke.exr", {"rgba.red", "rgba.green", "rgba.blue", "depth.Z"}, {1, 2, 3, 9});
    expectTexel("nuke.exr", {1, 2, 3});
    writeNamed("lone.exr", {"diffuse.B", "diffuse.G", "diffuse.R", "N.X", "N.Y", "N.Z"},
               {3, 2, 1, 0, 0, 1});
    expectTexel("lone.exr", {1, 2, 3});
    // The picture itself comes before layers, and there is nothing to tell.
    writeNamed("own.exr", {"B", "G", "R", "A", "direct.R", "direct.G", "direct.B", "Z"},
               {3, 2, 1, 1, 7, 7, 7, 7});
    expectTexel("own.exr", {1, 2, 3});
    EXPECT_EQ(baked({file("own.exr")}).facts.note, "");
}

TEST_F(PictureMeaning, PartsAreLayers) {
    std::vector<OIIO::ImageSpec> specs;
    for (const char* name : {"albedo", "beauty"}) {
        OIIO::ImageSpec spec(1, 1, 3, TypeDesc::FLOAT);
        spec.attribute("oiio:subimagename", name);
        specs.push_back(spec);
    }
    const auto output = OIIO::ImageOutput::create("openexr");
    ASSERT_TRUE(output->open(file("parts.exr").string(), 2, specs.data()));
    const std::array<float, 3> first{1, 1, 1}, second{0.25f, 0.5f, 0.75f};
    output->write_image(TypeDesc::FLOAT, first.data());
    output->open(file("parts.exr").string(), specs[1], OIIO::ImageOutput::AppendSubimage);
    output->write_image(TypeDesc::FLOAT, second.data());
    output->close();
    expectTexel("parts.exr", {0.25f, 0.5f, 0.75f});
}

TEST_F(PictureMeaning, FewAndManyChannels) {
    writeNamed("y.exr", {"Y"}, {0.5f});
    EXPECT_EQ(texels({file("y.exr")}), std::vector<float>{0.5f});
    writeNamed("r.exr", {"R"}, {0.5f});
    EXPECT_EQ(texels({file("r.exr")}), std::vector<float>{0.5f});
    writeNamed("rg.exr", {"R", "G"}, {0.5f, 0.25f});
    expectTexel("rg.exr", {0.5f, 0.25f, 0});
    EXPECT_NE(baked({file("rg.exr")}).facts.note, "");
    writeTexture(file("five.tif"), 1, 1, 5, TypeDesc::FLOAT, {1, 2, 3, 1, 5});
    expectTexel("five.tif", {1, 2, 3});
    writeNamed("none.exr", {"u", "v", "w"}, {1, 2, 3});
    EXPECT_TRUE(
        refusesWith(refusal([&] { baked({file("none.exr")}); }), 3, {"none.exr", "u, v, w"}));
}

TEST_F(PictureMeaning, XyzIsConverted) {
    // D65's white.
    writeNamed("white.exr", {"X", "Y", "Z"}, {0.9505f, 1, 1.0891f});
    expectTexel("white.exr", {1, 1, 1}, 2e-3f);
}

class Statement : public PictureMeaning {
  protected:
    void writeStated(const std::string& name, const std::vector<float>& chromaticities,
                     const std::string& interopId = {}) const {
        OIIO::ImageSpec spec(1, 1, 3, TypeDesc::FLOAT);
        if (!chromaticities.empty())
            spec.attribute("chromaticities", TypeDesc(TypeDesc::FLOAT, 8), chromaticities.data());
        if (!interopId.empty()) spec.attribute("colorInteropID", interopId);
        writePicture(file(name), spec, {0.2f, 0.5f, 0.1f});
    }
    const std::vector<float> kAp0{0.7347f, 0.2653f, 0, 1, 0.0001f, -0.077f, 0.32168f, 0.33767f};
    const std::vector<float> kAp1{0.713f, 0.293f, 0.165f,   0.83f,
                                  0.128f, 0.044f, 0.32168f, 0.33767f};
    // Not of any space that has a name.
    const std::vector<float> kOdd{0.68f, 0.31f, 0.2f, 0.7f, 0.14f, 0.05f, 0.3127f, 0.329f};
};

TEST_F(Statement, ChromaticitiesOfTheFile) {
    writeStated("ap0.exr", kAp0);
    expectTexel("ap0.exr", {-0.10f, 0.62f, 0.04f}, 0.01f);
    EXPECT_EQ(baked({file("ap0.exr")}).space.decidedBy, "the file");
    m_colour = ColourPipeline({.renderingSpace = "ACEScg"});
    writeStated("ap1.exr", kAp1);
    expectTexel("ap1.exr", {0.2f, 0.5f, 0.1f}, 1e-5f);
}

// White stays white, and the way back gives the same.
TEST_F(Statement, ChromaticitiesWithoutAName) {
    OIIO::ImageSpec spec(1, 1, 3, TypeDesc::FLOAT);
    spec.attribute("chromaticities", TypeDesc(TypeDesc::FLOAT, 8), kOdd.data());
    writePicture(file("white.exr"), spec, {1, 1, 1});
    expectTexel("white.exr", {1, 1, 1}, 1e-4f);
    writePicture(file("red.exr"), spec, {1, 0, 0});
    const auto red = texels({file("red.exr")});
    ASSERT_EQ(red.size(), 3u);
    // Wider than Rec.709's.
    EXPECT_GT(red[0], 1.05f);
    EXPECT_LT(red[1], 0.0f);
}

TEST_F(Statement, NamesOfSpacesAndOptionsAboveThem) {
    writeStated("named.exr", {}, "lin_ap0_scene");
    expectTexel("named.exr", {-0.10f, 0.62f, 0.04f}, 0.01f);
    writeStated("unknown.exr", {}, "somebody's own");
    expectTexel("unknown.exr", {0.2f, 0.5f, 0.1f});
    const auto values = texels({file("named.exr"), TextureKind::kColour, "lin_rec709_scene"});
    EXPECT_NEAR(values[0], 0.2f, 1e-6f);
    m_colour = ColourPipeline({.textureSpace = "lin_rec709_scene"});
    expectTexel("named.exr", {0.2f, 0.5f, 0.1f});
}

TEST_F(Statement, WithoutSenseIsNone) {
    writeStated("line.exr", {0.1f, 0.1f, 0.2f, 0.2f, 0.3f, 0.3f, 0.3127f, 0.329f});
    expectTexel("line.exr", {0.2f, 0.5f, 0.1f});
    const float nan = std::numeric_limits<float>::quiet_NaN();
    writeStated("nan.exr", {nan, 0.3f, 0.3f, 0.6f, 0.15f, 0.06f, 0.3127f, 0.329f});
    expectTexel("nan.exr", {0.2f, 0.5f, 0.1f});
}

TEST_F(PictureMeaning, BadTexelsAreZeroAndCounted) {
    const float nan = std::numeric_limits<float>::quiet_NaN(),
                infinite = std::numeric_limits<float>::infinity();
    writeTexture(file("bad.exr"), 5, 1, 3, TypeDesc::FLOAT,
                 {nan, 1, 2, 3, infinite, 4, -1, 5, -2, -infinite, 6, -3, 7, 8, 9});
    const BakedTexture texture = baked({file("bad.exr")});
    EXPECT_EQ(texture.facts.bad.notFinite, 3);
    EXPECT_EQ(texture.facts.bad.negative, 1);
    EXPECT_EQ(readLevels(texture.file)[0].values,
              (std::vector<float>{0, 1, 2, 3, 0, 4, 0, 5, 0, 0, 6, 0, 7, 8, 9}));
    // A number may be negative.
    writeTexture(file("number.exr"), 2, 1, 1, TypeDesc::FLOAT, {-1, nan});
    EXPECT_EQ(texels({file("number.exr"), TextureKind::kData}), (std::vector<float>{-1, 0}));
}

// OpenImageIO's name for what the file says of its alpha differs by format.
TEST_F(PictureMeaning, ColourIsStraight) {
    writeTexture(file("leaf.png"), 1, 1, 4, TypeDesc::UINT8, {1, 0.5f, 0, 0.25f});
    const auto png = texels({file("leaf.png")});
    ASSERT_EQ(png.size(), 3u);
    EXPECT_NEAR(png[0], 1.0f, 1e-3f);
    EXPECT_NEAR(png[1], 0.2159f, 1e-3f);
    // An EXR's colours are multiplied by its alpha: here they are divided again.
    writeNamed("leaf.exr", {"R", "G", "B", "A"}, {0.5f, 0.25f, 0, 0.5f});
    expectTexel("leaf.exr", {1, 0.5f, 0});
    OIIO::ImageSpec spec(1, 1, 4, TypeDesc::FLOAT);  // associated
    writePicture(file("leaf.tif"), spec, {0.5f, 0.25f, 0, 0.5f});
    expectTexel("leaf.tif", {1, 0.5f, 0});
}

// A flat normal map of each depth is .5 as a texture; the ends are those of the codes.
TEST_F(PictureMeaning, FlatNormalMapsAreTheMiddle) {
    const auto first = [&](const char* name, TypeDesc type, std::vector<float> values) {
        writeTexture(file(name), 1, 1, 3, type, values);
        return texels({file(name), TextureKind::kVector});
    };
    const float of8 = 128.0f / 255, of16 = 32768.0f / 65535;
    EXPECT_EQ(first("8.png", TypeDesc::UINT8, {of8, of8, 1}), (std::vector{0.5f, 0.5f, 1.0f}));
    EXPECT_EQ(first("8.tif", TypeDesc::UINT8, {of8, of8, 1}), (std::vector{0.5f, 0.5f, 1.0f}));
    EXPECT_EQ(first("16.png", TypeDesc::UINT16, {of16, of16, 1}), (std::vector{0.5f, 0.5f, 1.0f}));
    EXPECT_EQ(first("f.exr", TypeDesc::FLOAT, {0.5f, 0.5f, 1}), (std::vector{0.5f, 0.5f, 1.0f}));
    EXPECT_EQ(first("h.exr", TypeDesc::HALF, {0.5f, 0.5f, 1}), (std::vector{0.5f, 0.5f, 1.0f}));
    // 1 and 255 stand for -1 and 1.
    const auto ends = first("ends.png", TypeDesc::UINT8, {1.0f / 255, 64.5f / 255, 1});
    EXPECT_NEAR(ends[0], 0, 1e-6f);
    EXPECT_EQ(ends[2], 1.0f);
    // Other numbers stay as they are.
    writeTexture(file("n.png"), 1, 1, 3, TypeDesc::UINT8, {of8, of8, of8});
    EXPECT_EQ(texels({file("n.png"), TextureKind::kData}), std::vector{of8});
}

// A normal map that a number is to be made of is known by its texels; other pictures are not.
TEST_F(PictureMeaning, NormalMapsAreKnown) {
    const auto isLike = [&](const char* name, const std::function<Vector(float, float)>& colour) {
        constexpr int kSide = 16;
        std::vector<float> values;
        for (int y = 0; y < kSide; ++y)
            for (int x = 0; x < kSide; ++x) {
                const auto at = [](int i) {
                    return (static_cast<float>(i) + 0.5f) / kSide * 2 - 1;
                };
                const Vector c = colour(at(x), at(y));
                values.insert(values.end(), c.begin(), c.end());
            }
        writeTexture(file(name), kSide, kSide, 3, TypeDesc::UINT8, values);
        return baked({file(name), TextureKind::kData}).facts.isLikeNormals;
    };
    EXPECT_TRUE(isLike("flat.png", [](float, float) { return Vector{0.502f, 0.502f, 1}; }));
    EXPECT_TRUE(isLike("bumps.png", [](float x, float y) {
        const float z = std::sqrt(1 - 0.45f * (x * x + y * y));
        return Vector{0.5f + 0.335f * x, 0.5f + 0.335f * y, 0.5f + 0.5f * z};
    }));
    EXPECT_FALSE(isLike("grey.png", [](float x, float) {
        const float v = 0.5f + 0.5f * x;
        return Vector{v, v, v};
    }));
    EXPECT_FALSE(isLike("sky.png", [](float, float y) {
        return Vector{0.3f, 0.5f + 0.1f * y, 0.9f};
    }));
    EXPECT_FALSE(isLike("leaves.png", [](float x, float) {
        return Vector{0.2f, 0.5f + 0.2f * x, 0.1f};
    }));
    EXPECT_FALSE(isLike("white.png", [](float, float) { return Vector{1, 1, 1}; }));
}

TEST_F(PictureMeaning, TurnedOnesAreTakenAsStoredAndTold) {
    for (const char* name : {"turned.jpg", "turned.tif"}) {
        OIIO::ImageSpec spec(16, 8, 1, TypeDesc::UINT8);
        std::vector<float> values(16 * 8, 0.0f);
        for (std::size_t i = 0; i < values.size(); ++i) values[i] = i % 16 < 8 ? 1.0f : 0.0f;
        spec.attribute("Orientation", 6);
        writePicture(file(name), spec, values);
        const BakedTexture texture = baked({file(name), TextureKind::kData});
        EXPECT_EQ(texture.facts.width, 16) << name;
        EXPECT_NEAR(readLevels(texture.file)[0].values[0], 1, 0.02) << name;
        EXPECT_NE(texture.facts.note.find("(orientation 6)"), std::string::npos)
            << name << ": " << texture.facts.note;
        spec.attribute("Orientation", 1);
        writePicture(file(name), spec, values);
        EXPECT_EQ(baked({file(name), TextureKind::kData}).facts.note, "") << name;
    }
}

// Rows of 16 texels, left half white, of 1 bit: by one directory of tags.
void writeBits(const std::filesystem::path& path, bool isLittle, bool saysBits) {
    const auto number = [&](std::uint32_t value, int bytes) {
        std::string text;
        for (int i = 0; i < bytes; ++i)
            text += static_cast<char>(value >> (8 * (isLittle ? i : bytes - 1 - i)) & 255u);
        return text;
    };
    std::vector<std::array<std::uint32_t, 2>> tags{
        {256, 16}, {257, 4}, {258, 1}, {259, 1}, {262, 1}, {273, 0}, {277, 1}, {278, 4}, {279, 8}};
    if (!saysBits) tags.erase(tags.begin() + 2);
    const auto count = static_cast<std::uint32_t>(tags.size());
    std::string text = (isLittle ? "II" : "MM") + number(42, 2) + number(8, 4) + number(count, 2);
    for (const auto& [tag, value] : tags)
        text += number(tag, 2) + number(4, 2) + number(1, 4) +
                number(tag == 273 ? 14 + 12 * count : value, 4);
    text += number(0, 4);
    for (int row = 0; row < 4; ++row) text += std::string{'\xff', '\0'};
    std::ofstream(path, std::ios::binary) << text;
}

TEST_F(PictureMeaning, OneBitIsReadWhereTheFileSaysSo) {
    for (const bool isLittle : {false, true}) {
        writeBits(file("bits.tif"), isLittle, true);
        const auto values = texels({file("bits.tif"), TextureKind::kData});
        ASSERT_EQ(values.size(), 64u);
        EXPECT_EQ(values[0], 1.0f);
        EXPECT_EQ(values[15], 0.0f);
        writeBits(file("none.tif"), isLittle, false);
        EXPECT_TRUE(refusesWith(refusal([&] { baked({file("none.tif")}); }), 3,
                                {"none.tif", "BitsPerSample"}));
    }
}

TEST_F(PictureMeaning, WhatAFileIsCalledSaysNothing) {
    writeTexture(file("real.png"), 1, 1, 3, TypeDesc::UINT8, {1, 1, 1});
    std::filesystem::copy(file("real.png"), file("lies.jpg"));
    expectTexel("lies.jpg", {1, 1, 1});
}

}  // namespace
}  // namespace pm::host::test
