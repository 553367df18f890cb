// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include <cmath>

#include "tests/textures/texture_support.h"

namespace pm::host::test {
namespace {

constexpr float kDarkCode = 64.0f / 255.0f;

class Bake : public TextureTest {
  protected:
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
};

TEST_F(Bake, ConvertsBeforeItFilters) {
    writeCheckerboard("checker.png", 128);
    const BakedTexture texture = baked({file("checker.png")});
    EXPECT_EQ(texture.facts.width, 128);
    EXPECT_EQ(texture.facts.channels, 3);
    EXPECT_EQ(texture.space.name, "sRGB texture");
    EXPECT_EQ(texture.file.extension(), ".tx");
    const auto levels = readLevels(texture.file);
    ASSERT_EQ(levels.size(), 8u);
    EXPECT_EQ(levels[0].spec.tile_width, 64);
    EXPECT_EQ(levels[7].spec.width, 1);
    // The mean of the light, not the light of the mean code (0.344).
    const double mean = (1.0 + std::pow((kDarkCode + 0.055) / 1.055, 2.4)) / 2;
    for (std::size_t level = 1; level < 8; ++level) {
        for (const float value : levels[level].values) ASSERT_NEAR(value, mean, 1e-3) << level;
    }
}

// Before, between and within its steps; nothing of the texture is left, and it can be made later.
TEST_F(Bake, IsGivenUpBetweenSteps) {
    struct Stopped {};
    int left = 0;
    writeCheckerboard("other.png", 16);
    for (int at = 1; at <= 2; ++at) {
        TexturePreparer stopping = preparer([&] {
            if (--left == 0) throw Stopped();
        });
        left = at;
        EXPECT_THROW(stopping.texture({file("other.png")}), Stopped);
        left = 0;
        EXPECT_TRUE(std::filesystem::exists(baked({file("other.png")}).file));
        std::filesystem::remove_all(cacheFolder());
    }
}

TEST_F(Bake, CodesBecomeLinearLight) {
    std::vector<float> values;
    for (int i = 0; i < 256; ++i) values.insert(values.end(), 3, static_cast<float>(i) / 255.0f);
    writeTexture(file("ramp.png"), 16, 16, 3, OIIO::TypeDesc::UINT8, values);
    const auto levels = readLevels(baked({file("ramp.png")}).file);
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
    const auto levels = readLevels(baked({file("red.png")}).file);
    ASSERT_EQ(levels.size(), 1u);
    EXPECT_NEAR(levels[0].values[0], 0.613097f, 4e-4f);
    EXPECT_NEAR(levels[0].values[1], 0.070194f, 4e-5f);
    EXPECT_NEAR(levels[0].values[2], 0.020616f, 4e-5f);
}

TEST_F(Bake, NothingIsClipped) {
    writeTexture(file("sky.exr"), 2, 1, 3, OIIO::TypeDesc::FLOAT, {1e6f, 0.5f, 3, 70000, 1, 2});
    const BakedTexture texture = baked({file("sky.exr")});
    EXPECT_EQ(texture.space.name, "Linear Rec.709");
    const auto levels = readLevels(texture.file);
    ASSERT_GE(levels.size(), 1u);
    EXPECT_EQ(levels[0].values, (std::vector<float>{1e6f, 0.5f, 3, 70000, 1, 2}));
    writeTexture(file("log.png"), 1, 1, 3, OIIO::TypeDesc::UINT8, {1, 1, 0.5f});
    m_colour = ColourPipeline({.renderingSpace = "ACES2065-1", .textureSpace = "acescg"});
    EXPECT_NEAR(texels({file("log.png")})[2], 0.511f, 0.02f);
}

TEST_F(Bake, DataIsNeverConverted) {
    std::vector<float> values;
    for (int i = 0; i < 256; ++i) values.push_back(static_cast<float>(i) / 255.0f);
    writeTexture(file("rough.png"), 16, 16, 1, OIIO::TypeDesc::UINT8, values);
    // Not even when somebody says sRGB.
    const BakedTexture number = baked({file("rough.png"), TextureKind::kData, "sRGB"});
    EXPECT_TRUE(number.space.isData);
    EXPECT_EQ(number.facts.channels, 1);
    const auto levels = readLevels(number.file);
    for (std::size_t i = 0; i < 256; ++i) EXPECT_FLOAT_EQ(levels[0].values[i], values[i]);
    // A raw colour map keeps its values too, but is a colour.
    const BakedTexture raw = baked({file("rough.png"), TextureKind::kColour, "raw"});
    EXPECT_NEAR(readLevels(raw.file)[0].values[77], 77.0f / 255, 2e-4f);
    EXPECT_NE(raw.file, number.file);
}

// Of a normal map all three channels are numbers: of 8 bits 128 is the middle.
TEST_F(Bake, VectorsKeepTheirThreeNumbers) {
    const std::vector<float> values{128.0f / 255, 64.0f / 255, 1.0f, 0.0f, 200.0f / 255, 0.5f};
    writeTexture(file("normal.png"), 2, 1, 3, OIIO::TypeDesc::UINT8, values);
    const BakedTexture normal = baked({file("normal.png"), TextureKind::kVector, "sRGB"});
    EXPECT_TRUE(normal.space.isData);
    EXPECT_EQ(normal.facts.channels, 3);
    const auto levels = readLevels(normal.file);
    for (std::size_t i = 0; i < 5; ++i)
        EXPECT_NEAR(levels[0].values[i], 0.5f + (values[i] * 255 - 128) / 254, 1e-6f);
}

// Codes of 16 bits, with the curve and a matrix, against the conversion itself.
TEST_F(Bake, TablesAreTheConversion) {
    m_colour = ColourPipeline({.renderingSpace = "ACEScg"});
    std::vector<float> values;
    for (int i = 0; i < 64 * 3; ++i) values.push_back(static_cast<float>(i * 37 % 256) / 255.0f);
    writeTexture(file("deep.tif"), 8, 8, 3, OIIO::TypeDesc::UINT16, values);
    writeTexture(file("flat.png"), 8, 8, 3, OIIO::TypeDesc::UINT8, values);
    std::vector<float> right = values;
    m_colour.textureToRendering(m_colour.textureSpace("x.png", false, "")).apply(right, 3);
    const auto deep = texels({file("deep.tif")}), flat = texels({file("flat.png")});
    ASSERT_EQ(deep.size(), right.size());
    ASSERT_EQ(flat.size(), right.size());
    for (std::size_t i = 0; i < right.size(); ++i) {
        EXPECT_NEAR(deep[i], right[i], 5e-5f) << i;
        EXPECT_NEAR(flat[i], right[i], 5e-4f) << i;
    }
}

// Grey stays grey in all of the built-in spaces, and needs one channel only.
TEST_F(Bake, GreyHasOneChannel) {
    writeTexture(file("grey.png"), 1, 1, 1, OIIO::TypeDesc::UINT8, {128.0f / 255});
    for (const char* space : {"", "ACEScg", "ACES2065-1"}) {
        m_colour = ColourPipeline({.renderingSpace = space});
        const auto values = texels({file("grey.png")});
        ASSERT_EQ(values.size(), 1u) << space;
        EXPECT_NEAR(values[0], 0.2159f, 2e-4f) << space;
    }
}

TEST_F(Bake, TiledFilesThatNeedNothingAreUsedAsTheyAre) {
    std::vector<float> values(128 * 128 * 3, 0.5f);
    values[0] = 0.25f;
    writeTexture(file("scene.exr"), 128, 128, 3, OIIO::TypeDesc::HALF, values);
    // One of our own: in the rendering space.
    const std::filesystem::path made = baked({file("scene.exr")}).file;
    std::filesystem::copy(made, file("made.tx"));
    const BakedTexture asItIs = baked({file("made.tx")});
    EXPECT_EQ(asItIs.file, file("made.tx"));
    EXPECT_EQ(asItIs.facts.texelHash, baked({file("scene.exr")}).facts.texelHash);
    // Again, from what was recorded.
    EXPECT_EQ(baked({file("made.tx")}).file, file("made.tx"));
    // In another space it has to be converted.
    m_colour = ColourPipeline({.renderingSpace = "ACEScg"});
    EXPECT_NE(baked({file("made.tx")}).file, file("made.tx"));
}

TEST_F(Bake, OnceForEachFileSpaceAndKind) {
    writeCheckerboard("checker.png", 8);
    const auto first = baked({file("checker.png")}).file;
    EXPECT_EQ(baked({folder() / "cache" / ".." / "checker.png"}).file, first);
    const auto other = baked({file("checker.png"), TextureKind::kColour, "acescg"}).file;
    EXPECT_NE(other, first);
    EXPECT_NE(baked({file("checker.png"), TextureKind::kMask}).file, first);
    std::size_t count = 0;
    for (const auto& entry : std::filesystem::directory_iterator(cacheFolder() / "textures")) {
        EXPECT_FALSE(entry.path().filename().string().starts_with("tmp-"));
        count += entry.path().extension() == ".tx" ? 1 : 0;
    }
    EXPECT_EQ(count, 3u);
}

TEST_F(Bake, OddSizesAndLongOnes) {
    for (const auto& [width, height] : {std::pair{1, 1}, {3, 7}, {130, 1}, {65, 63}}) {
        const std::string name = std::to_string(width) + ".png";
        const auto size = static_cast<std::size_t>(width * height) * 3;
        writeTexture(file(name), width, height, 3, OIIO::TypeDesc::UINT8,
                     std::vector<float>(size, 1.0f));
        const auto levels = readLevels(baked({file(name)}).file);
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
