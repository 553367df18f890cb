// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Look-ups in pictures whose texels are known: between texels, at edges, over footprints.
#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "plugin/textures/texture_system.h"

namespace pm::plugin::test {
namespace {

using Value = std::function<float(int x, int y, int channel)>;

// A picture of floats, tiled, with all its levels, each the mean of the one before.
class FilterTest : public testing::Test {
  protected:
    ~FilterTest() override {
        for (const std::string& file : m_files) std::filesystem::remove(file);
    }

    std::string write(int width, int height, int channels, const Value& value, bool hasLevels,
                      OIIO::TypeDesc type = OIIO::TypeDesc::FLOAT) {
        m_files.push_back(testing::TempDir() + "filter_" + std::to_string(m_files.size()) + "_" +
                          std::to_string(::getpid()) + (hasLevels ? ".exr" : ".tif"));
        const auto out = OIIO::ImageOutput::create(m_files.back());
        std::vector<float> texels;
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x)
                for (int c = 0; c < channels; ++c) texels.push_back(value(x, y, c));
        for (int w = width, h = height;;) {
            OIIO::ImageSpec spec(w, h, channels, type);
            spec.tile_width = spec.tile_height = 16;
            if (hasLevels) spec.attribute("textureformat", "Plain Texture");
            if (hasLevels) spec.attribute("openexr:roundingmode", 0);
            EXPECT_TRUE(out->open(
                m_files.back(), spec,
                w == width ? OIIO::ImageOutput::Create : OIIO::ImageOutput::AppendMIPLevel));
            EXPECT_TRUE(out->write_image(OIIO::TypeDesc::FLOAT, texels.data()));
            if (!hasLevels || (w == 1 && h == 1)) break;
            texels = halved(texels, w, h, channels);
            w = std::max(1, w / 2);
            h = std::max(1, h / 2);
        }
        EXPECT_TRUE(out->close());
        return m_files.back();
    }

    TexturePicture open(const std::string& file, Wrap wrap = Wrap::kRepeat) {
        TextureDescription description;
        description.fileName = file;
        description.wrapS = description.wrapT = wrap;
        return m_system.open(description);
    }

    Texel lookUp(const TexturePicture& picture, Vec2f uv, const UvFootprint& footprint = {}) {
        Texel texel;
        EXPECT_TRUE(m_system.lookUp(picture, uv, footprint, texel));
        return texel;
    }

    TextureSystem m_system;

  private:
    static std::vector<float> halved(const std::vector<float>& texels, int w, int h, int channels) {
        std::vector<float> half;
        for (int y = 0; y < std::max(1, h / 2); ++y)
            for (int x = 0; x < std::max(1, w / 2); ++x)
                for (int c = 0; c < channels; ++c) {
                    const auto at = [&](int i, int j) {
                        const int row = std::min(h - 1, 2 * y + j),
                                  column = std::min(w - 1, 2 * x + i);
                        return texels[static_cast<std::size_t>((row * w + column) * channels + c)];
                    };
                    half.push_back((at(0, 0) + at(1, 0) + at(0, 1) + at(1, 1)) / 4);
                }
        return half;
    }

    std::vector<std::string> m_files;
};

float checks(int x, int y, int c) {
    return static_cast<float>((x * 7 + y * 13 + c * 5) % 11) / 8.0f;
}

// The texel of column x and row y, counted from the upper left, as a wrap has it.
float wrapped(int x, int y, int c, int side, Wrap wrap) {
    const auto in = [&](int v) {
        if (wrap == Wrap::kRepeat) return ((v % side) + side) % side;
        if (wrap == Wrap::kClamp) return std::clamp(v, 0, side - 1);
        const int period = ((v % (2 * side)) + 2 * side) % (2 * side);
        return period < side ? period : 2 * side - 1 - period;
    };
    const bool isOutside = x < 0 || y < 0 || x >= side || y >= side;
    return wrap == Wrap::kBlack && isOutside ? 0.0f : checks(in(x), in(y), c);
}

TEST_F(FilterTest, BetweenTexelsAndBeyondEdges) {
    constexpr int kSide = 40;  // more than two tiles, the last of them cut
    const std::string file = write(kSide, kSide, 3, checks, false);
    for (const Wrap wrap : {Wrap::kRepeat, Wrap::kClamp, Wrap::kMirror, Wrap::kBlack}) {
        const TexturePicture picture = open(file, wrap);
        for (int i = -60; i <= 100; i += 5)
            for (int j = -60; j <= 100; j += 7) {
                // Of texels' middles, in quarters of a texel.
                const float x = static_cast<float>(i) + 0.25f, y = static_cast<float>(j) + 0.5f;
                const Texel found =
                    lookUp(picture, {(x + 0.5f) / kSide, 1.0f - (y + 0.5f) / kSide});
                for (int c = 0; c < 3; ++c) {
                    const auto t = [&](int di, int dj) {
                        return wrapped(i + di, j + dj, c, kSide, wrap);
                    };
                    const float right = 0.25f, lower = 0.5f;
                    const float expected = (1 - lower) * ((1 - right) * t(0, 0) + right * t(1, 0)) +
                                           lower * ((1 - right) * t(0, 1) + right * t(1, 1));
                    const float channel = c == 0 ? found.r : c == 1 ? found.g : found.b;
                    ASSERT_NEAR(channel, expected, 2e-4f)
                        << "wrap " << static_cast<int>(wrap) << " x " << x << " y " << y;
                }
            }
    }
}

TEST_F(FilterTest, CodesOfAllKindsAreTheirNumbers) {
    const auto ramp = [](int x, int, int) { return static_cast<float>(x) / 15.0f; };
    for (const auto type : {OIIO::TypeDesc::UINT8, OIIO::TypeDesc::UINT16, OIIO::TypeDesc::FLOAT,
                            OIIO::TypeDesc::HALF})
        for (const int channels : {1, 2, 3, 4}) {
            const bool isHalf = type == OIIO::TypeDesc::HALF;
            const TexturePicture picture = open(write(16, 16, channels, ramp, isHalf, type));
            for (int x = 0; x < 16; ++x) {
                const Texel found = lookUp(picture, {(static_cast<float>(x) + 0.5f) / 16, 0.4f});
                const float expected = static_cast<float>(x) / 15.0f;
                const float allowed = isHalf ? 3e-4f : 1e-5f;
                EXPECT_NEAR(found.r, expected, allowed) << type << " " << channels;
                EXPECT_NEAR(found.b, expected, allowed) << type << " " << channels;
                EXPECT_NEAR(found.a, channels == 2 || channels == 4 ? expected : 1.0f, allowed);
            }
        }
}

TEST_F(FilterTest, TinyAndInfiniteHalves) {
    const std::vector<float> values{0x1p-24f, 0x1.8p-15f, -0x1p-14f, 65504.0f};
    const TexturePicture picture = open(write(
        4, 1, 1, [&](int x, int, int) { return values[static_cast<std::size_t>(x)]; }, true,
        OIIO::TypeDesc::HALF));
    for (std::size_t x = 0; x < values.size(); ++x)
        EXPECT_EQ(lookUp(picture, {(static_cast<float>(x) + 0.5f) / 4, 0.5f}).r, values[x]);
    const TexturePicture infinite = open(write(
        1, 1, 1, [](int, int, int) { return INFINITY; }, true, OIIO::TypeDesc::HALF));
    Texel texel;
    EXPECT_FALSE(m_system.lookUp(infinite, {0.5f, 0.5f}, {}, texel));
}

// Stripes of one texel, black and white, that run down.
TEST_F(FilterTest, FootprintsAreMeansOverWhatTheyCover) {
    const TexturePicture picture = open(write(
        256, 256, 1, [](int x, int, int) { return x % 2 ? 1.0f : 0.0f; }, true));
    const float texel = 1.0f / 256;
    const Vec2f onWhite{101.5f * texel, 0.5f};
    EXPECT_NEAR(lookUp(picture, onWhite).r, 1.0f, 1e-6f);
    // A long way along a stripe, however long: by several probes.
    for (const float length : {2.0f, 8.0f, 15.0f})
        EXPECT_NEAR(lookUp(picture, onWhite, {{texel, 0}, {0, length * texel}}).r, 1.0f, 1e-4f);
    // Across them, in any order of the sides.
    for (const float length : {8.0f, 15.0f})
        for (const bool isTurned : {false, true}) {
            const Vec2f across{length * texel, 0}, down{0, texel};
            EXPECT_NEAR(lookUp(picture, onWhite,
                               isTurned ? UvFootprint{down, across} : UvFootprint{across, down})
                            .r,
                        0.5f, 0.13f);
        }
    for (const float side : {2.0f, 4.0f, 77.0f, 256.0f, 1e6f})
        EXPECT_NEAR(lookUp(picture, onWhite, {{side * texel, 0}, {0, side * texel}}).r, 0.5f,
                    1e-4f);
}

// Between two levels both count; the mean grows from the one's to the other's without a step.
TEST_F(FilterTest, LevelsGoOverIntoEachOther) {
    const TexturePicture picture = open(write(
        64, 64, 1, [](int x, int y, int) { return x == 21 && y == 21 ? 64.0f : 0.0f; }, true));
    float before = 64.0f;
    for (float side = 1.0f; side < 40.0f; side *= 1.01f) {
        const float value =
            lookUp(picture, {21.5f / 64, 1 - 21.5f / 64}, {{side / 64, 0}, {0, side / 64}}).r;
        EXPECT_LE(value, before * 1.0001f) << side;
        EXPECT_GE(value, before * 0.85f) << side;
        before = value;
    }
    EXPECT_LT(before, 0.2f);
}

TEST_F(FilterTest, BlackIsKnownWithoutALookAtEveryTexel) {
    const auto spot = [](int x, int y, int) { return x == 200 && y == 55 ? 1e-3f : 0.0f; };
    const TexturePicture picture = open(write(256, 256, 3, spot, true));
    const auto box = [](int x, int y, int size) {
        const Vec2f lo{static_cast<float>(x) / 256, 1 - static_cast<float>(y + size) / 256};
        return std::array<Vec2f, 2>{lo, lo + Vec2f{1, 1} * (static_cast<float>(size) / 256)};
    };
    const auto isBlack = [&](const std::array<Vec2f, 2>& b) {
        return m_system.isBlackWithin(picture, b[0], b[1]);
    };
    for (int y = 0; y < 256; y += 8)
        for (int x = 0; x < 256; x += 8)
            for (const int size : {3, 8, 24}) {
                const bool hasSpot = x <= 200 && 200 < x + size && y <= 55 && 55 < y + size;
                EXPECT_FALSE(hasSpot && isBlack(box(x, y, size))) << x << " " << y << " " << size;
            }
    EXPECT_TRUE(isBlack(box(16, 160, 24)));
    EXPECT_TRUE(isBlack(box(100, 100, 8)));
    // Without levels nothing is known.
    EXPECT_FALSE(m_system.isBlackWithin(open(write(
                                            64, 64, 1, [](int, int, int) { return 0.0f; }, false)),
                                        {0, 0}, {0.1f, 0.1f}));
}

// The same bits whatever may be held.
TEST_F(FilterTest, MemoryChangesNothing) {
    const TexturePicture picture = open(write(512, 512, 4, checks, true));
    const auto all = [&] {
        std::vector<float> found;
        for (int i = 0; i < 4000; ++i) {
            const auto u = static_cast<float>(i * 37 % 512) / 512, v = static_cast<float>(i) / 4000;
            const float side = 1e-3f * static_cast<float>(i % 50);
            found.push_back(lookUp(picture, {u, v}, {{side, 0}, {0, side}}).g);
        }
        return found;
    };
    m_system.holdAtMost(TextureSystem::kLeastBytes);
    const std::vector<float> little = all();
    m_system.holdAtMost(std::uint64_t{1} << 30, std::uint64_t{1} << 20);
    EXPECT_EQ(all(), little);
}

}  // namespace
}  // namespace pm::plugin::test
