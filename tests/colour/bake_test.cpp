// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/colour/texture_bake.h"
#include "tests/colour/bake_support.h"
#include "tests/colour/scratch.h"

#include <cmath>
#include <limits>

namespace pm::host::test {
namespace {

constexpr float kDarkCode = 64.0f / 255.0f;

class Bake : public ScratchTest {
  protected:
    Bake() { std::filesystem::create_directory(file("tx")); }
    TextureBaker baker() const { return TextureBaker(m_colour, file("tx")); }

    // Dark grey (kDarkCode) and white texels in turn.
    void writeCheckerboard(const std::string& name, int side) const {
        std::vector<float> values;
        for (int y = 0; y < side; ++y) {
            for (int x = 0; x < side; ++x) {
                values.insert(values.end(), 3, (x + y) % 2 == 0 ? kDarkCode : 1.0f);
            }
        }
        writeTexture(file(name), side, side, 3, OIIO::TypeDesc::UINT8, values);
    }

    ColourPipeline m_colour{ColourOptions{}};
};

TEST_F(Bake, ConvertsBeforeItFilters) {
    writeCheckerboard("checker.png", 128);
    TextureBaker baking = baker();
    const BakedTexture& baked = baking.bake({file("checker.png")});
    EXPECT_EQ(baked.width, 128);
    EXPECT_EQ(baked.channels, 3);
    EXPECT_EQ(baked.space.name, "sRGB texture");
    EXPECT_EQ(baked.file.extension(), ".tx");
    const auto levels = readLevels(baked.file);
    ASSERT_EQ(levels.size(), 8u);
    EXPECT_EQ(levels[0].spec.tile_width, 64);
    EXPECT_EQ(levels[7].spec.width, 1);
    // The mean of the light, not the light of the mean code (0.344).
    const double mean = (1.0 + std::pow((kDarkCode + 0.055) / 1.055, 2.4)) / 2;
    for (std::size_t level = 1; level < 8; ++level) {
        for (const float value : levels[level].values) ASSERT_NEAR(value, mean, 1e-3) << level;
    }
}

// Between any two of its steps; nothing of the texture is left, and it can be baked later.
// Asked at least before reading, converting and writing, and while that takes long.
TEST_F(Bake, IsGivenUpBetweenSteps) {
    struct Stopped {};
    int left = 0;
    TextureBaker baking(m_colour, file("tx"), [&] {
        if (--left == 0) throw Stopped();
    });
    writeCheckerboard("other.png", 16);
    for (int at = 1; at <= 3; ++at) {
        left = at;
        EXPECT_THROW(baking.bake({file("other.png")}), Stopped);
    }
    left = 0;
    EXPECT_TRUE(std::filesystem::exists(baking.bake({file("other.png")}).file));
}

TEST_F(Bake, CodesBecomeLinearLight) {
    std::vector<float> values;
    for (int i = 0; i < 256; ++i) values.insert(values.end(), 3, static_cast<float>(i) / 255.0f);
    writeTexture(file("ramp.png"), 16, 16, 3, OIIO::TypeDesc::UINT8, values);
    TextureBaker baking = baker();
    const auto levels = readLevels(baking.bake({file("ramp.png")}).file);
    ASSERT_EQ(levels.size(), 5u);
    EXPECT_EQ(levels[0].spec.format, OIIO::TypeDesc::HALF);
    for (std::size_t i = 0; i < 256; ++i) {
        const double code = static_cast<double>(i) / 255;
        const double linear =
            code <= 0.04045 ? code / 12.92 : std::pow((code + 0.055) / 1.055, 2.4);
        EXPECT_NEAR(levels[0].values[3 * i + 1], linear, 1e-6 + linear / 2000) << i;
    }
}

TEST_F(Bake, IntoTheRenderingSpace) {
    m_colour = ColourPipeline({.renderingSpace = "ACEScg"});
    writeTexture(file("red.png"), 1, 1, 3, OIIO::TypeDesc::UINT8, {1, 0, 0});
    TextureBaker baking = baker();
    const auto levels = readLevels(baking.bake({file("red.png")}).file);
    ASSERT_EQ(levels.size(), 1u);
    EXPECT_NEAR(levels[0].values[0], 0.613097f, 4e-4f);
    EXPECT_NEAR(levels[0].values[1], 0.070194f, 4e-5f);
    EXPECT_NEAR(levels[0].values[2], 0.020616f, 4e-5f);
}

TEST_F(Bake, NothingIsClipped) {
    writeTexture(file("sky.exr"), 2, 1, 3, OIIO::TypeDesc::FLOAT, {1e6f, -0.5f, 3, 70000, 1, 2});
    TextureBaker baking = baker();
    const BakedTexture& baked = baking.bake({file("sky.exr")});
    EXPECT_EQ(baked.space.name, "Linear Rec.709");
    const auto levels = readLevels(baked.file);
    ASSERT_GE(levels.size(), 1u);
    EXPECT_EQ(levels[0].values, (std::vector<float>{1e6f, -0.5f, 3, 70000, 1, 2}));
    // Codes in a log space reach far beyond 1.
    writeTexture(file("log.png"), 1, 1, 3, OIIO::TypeDesc::UINT8, {1, 1, 0.5f});
    const ColourPipeline wide({.renderingSpace = "ACES2065-1", .textureSpace = "acescg"});
    TextureBaker wideBaking(wide, file("tx"));
    EXPECT_NEAR(readLevels(wideBaking.bake({file("log.png")}).file)[0].values[2], 0.511f, 0.02f);
}

TEST_F(Bake, DataIsNeverConverted) {
    std::vector<float> values;
    for (int i = 0; i < 256; ++i) values.push_back(static_cast<float>(i) / 255.0f);
    writeTexture(file("rough.png"), 16, 16, 1, OIIO::TypeDesc::UINT8, values);
    TextureBaker baking = baker();
    // Not even when somebody says sRGB.
    const BakedTexture& baked = baking.bake({file("rough.png"), TextureKind::kData, "sRGB"});
    EXPECT_TRUE(baked.space.isData);
    EXPECT_EQ(baked.channels, 1);
    const auto levels = readLevels(baked.file);
    for (std::size_t i = 0; i < 256; ++i) EXPECT_FLOAT_EQ(levels[0].values[i], values[i]);
    // A raw colour map keeps its values too, but is a colour.
    const BakedTexture& raw = baking.bake({file("rough.png"), TextureKind::kColour, "raw"});
    EXPECT_EQ(raw.channels, 3);
    EXPECT_NEAR(readLevels(raw.file)[0].values[3 * 77], 77.0f / 255, 2e-4f);
    EXPECT_NE(raw.file, baked.file);
}

TEST_F(Bake, AlphaIsKeptAndColourStaysStraight) {
    writeTexture(file("leaf.png"), 1, 1, 4, OIIO::TypeDesc::UINT8, {1, 0.5f, 0, 0.25f});
    TextureBaker baking = baker();
    const auto levels = readLevels(baking.bake({file("leaf.png")}).file);
    ASSERT_EQ(levels[0].spec.nchannels, 4);
    EXPECT_EQ(levels[0].spec.alpha_channel, 3);
    EXPECT_NEAR(levels[0].values[0], 1.0f, 1e-3f);
    EXPECT_NEAR(levels[0].values[1], 0.2159f, 1e-3f);
    EXPECT_NEAR(levels[0].values[3], 64.0f / 255, 1e-3f);
    // An EXR's colours are multiplied by its alpha: here they are divided again.
    writeTexture(file("leaf.exr"), 1, 1, 4, OIIO::TypeDesc::FLOAT, {0.5f, 0.25f, 0, 0.5f});
    const auto fromExr = readLevels(baking.bake({file("leaf.exr")}).file);
    EXPECT_EQ(fromExr[0].values, (std::vector<float>{1, 0.5f, 0, 0.5f}));
    // Grey with alpha becomes RGBA.
    writeTexture(file("grey.png"), 1, 1, 2, OIIO::TypeDesc::UINT8, {1, 0.2f});
    const auto fromGrey = readLevels(baking.bake({file("grey.png")}).file);
    ASSERT_EQ(fromGrey[0].values.size(), 4u);
    EXPECT_NEAR(fromGrey[0].values[2], 1.0f, 1e-3f);
    EXPECT_NEAR(fromGrey[0].values[3], 0.2f, 1e-3f);
}

TEST_F(Bake, BadTexelsAreCounted) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    writeTexture(file("bad.exr"), 2, 1, 3, OIIO::TypeDesc::FLOAT,
                 {nan, 1, 2, 3, std::numeric_limits<float>::infinity(), 4});
    TextureBaker baking = baker();
    const BakedTexture& baked = baking.bake({file("bad.exr")});
    EXPECT_EQ(baked.badTexels, 2);
    EXPECT_EQ(readLevels(baked.file)[0].values, (std::vector<float>{0, 1, 2, 3, 0, 4}));
}

TEST_F(Bake, OnceForEachFileSpaceAndWrap) {
    writeCheckerboard("checker.png", 8);
    TextureBaker baking = baker();
    const auto first = baking.bake({file("checker.png")}).file;
    EXPECT_EQ(baking.bake({file("checker.png")}).file, first);
    EXPECT_EQ(baking.bake({folder() / "tx" / ".." / "checker.png"}).file, first);
    const auto other = baking.bake({file("checker.png"), TextureKind::kColour, "acescg"}).file;
    EXPECT_NE(other, first);
    const auto clamped = baking.bake({file("checker.png"), TextureKind::kColour, "", true}).file;
    EXPECT_EQ(readLevels(first)[0].spec.get_string_attribute("wrapmodes"), "periodic,periodic");
    EXPECT_EQ(readLevels(clamped)[0].spec.get_string_attribute("wrapmodes"), "clamp,clamp");
    std::size_t count = 0;
    for (const auto& entry : std::filesystem::directory_iterator(file("tx"))) {
        EXPECT_EQ(entry.path().extension(), ".tx");
        EXPECT_EQ(entry.path().string().find(".tmp."), std::string::npos);
        ++count;
    }
    EXPECT_EQ(count, 3u);
    // The same again in another run has the same name.
    std::filesystem::remove(first);
    TextureBaker again = baker();
    EXPECT_EQ(again.bake({file("checker.png")}).file, first);
}

TEST_F(Bake, OddSizesAndLongOnes) {
    for (const auto& [width, height] : {std::pair{1, 1}, {3, 7}, {130, 1}, {65, 63}}) {
        const std::string name = std::to_string(width) + ".png";
        const auto size = static_cast<std::size_t>(width * height) * 3;
        writeTexture(file(name), width, height, 3, OIIO::TypeDesc::UINT8,
                     std::vector<float>(size, 1.0f));
        TextureBaker baking = baker();
        const auto levels = readLevels(baking.bake({file(name)}).file);
        ASSERT_FALSE(levels.empty());
        EXPECT_EQ(levels[0].spec.width, width);
        EXPECT_EQ(levels[0].spec.height, height);
        EXPECT_EQ(levels.back().spec.width * levels.back().spec.height, 1);
        for (const Level& level : levels) {
            for (const float value : level.values) ASSERT_NEAR(value, 1.0f, 1e-3f) << width;
        }
    }
}

}  // namespace
}  // namespace pm::host::test
