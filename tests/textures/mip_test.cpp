// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include <xxhash.h>

#include <cmath>
#include <cstring>
#include <numeric>

#include "host_shim/textures/row_halver.h"
#include "tests/textures/texture_support.h"

namespace pm::host::test {
namespace {

std::vector<float> halved(int width, int height, int channels, const std::vector<float>& values) {
    std::vector<float> result;
    const auto size = static_cast<std::size_t>(std::max(1, width / 2) * channels);
    RowHalver halver(width, height, channels,
                     [&](const float* row) { result.insert(result.end(), row, row + size); });
    for (int y = 0; y < height; ++y)
        halver.add(&values[static_cast<std::size_t>(y * width * channels)]);
    return result;
}

TEST(RowHalver, TwoByTwo) {
    EXPECT_EQ(halved(4, 2, 1, {1, 2, 3, 4, 5, 6, 7, 8}), (std::vector<float>{3.5f, 5.5f}));
    EXPECT_EQ(halved(2, 2, 3, {1, 2, 3, 5, 6, 7, 1, 2, 3, 5, 6, 7}), (std::vector<float>{3, 4, 5}));
}

// Of five texels the middle one is shared by both.
TEST(RowHalver, OddSizesAreMeansOverAreas) {
    const auto row = halved(5, 1, 1, {1, 2, 3, 4, 5});
    ASSERT_EQ(row.size(), 2u);
    EXPECT_NEAR(row[0], (1 + 2 + 3 * 0.5) / 2.5, 1e-6);
    EXPECT_NEAR(row[1], (3 * 0.5 + 4 + 5) / 2.5, 1e-6);
    for (const auto& [width, height] : {std::pair{3, 7}, {7, 3}, {1, 9}, {13, 1}, {65, 63}}) {
        std::vector<float> values(static_cast<std::size_t>(width * height));
        std::iota(values.begin(), values.end(), 1.0f);
        const double before =
            std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
        const auto after = halved(width, height, 1, values);
        ASSERT_EQ(after.size(), static_cast<std::size_t>(std::max(1, width / 2)) *
                                    static_cast<std::size_t>(std::max(1, height / 2)));
        EXPECT_NEAR(
            std::accumulate(after.begin(), after.end(), 0.0) / static_cast<double>(after.size()),
            before, before * 1e-5)
            << width << " x " << height;
    }
}

class Mips : public TextureTest {};

// What the library would make of the file: of its shape and then all its texels.
TEST_F(Mips, TheHashIsThatOfTheStoredTexels) {
    std::vector<float> values;
    for (int i = 0; i < 130 * 70 * 3; ++i) values.push_back(static_cast<float>(i % 251) / 250.0f);
    writeTexture(file("a.png"), 130, 70, 3, OIIO::TypeDesc::UINT8, values);
    writeTexture(file("a.exr"), 130, 70, 3, OIIO::TypeDesc::FLOAT, values);
    for (const char* name : {"a.png", "a.exr"}) {
        const BakedTexture texture = baked({file(name)});
        const auto input = OIIO::ImageInput::open(texture.file.string());
        const OIIO::ImageSpec& spec = input->spec();
        std::vector<std::byte> bytes(spec.image_bytes(true));
        input->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::UNKNOWN, bytes.data());
        const std::array<std::int64_t, 4> shape{spec.width, spec.height, spec.nchannels,
                                                spec.format.basetype};
        const auto hash = XXH3_128bits_withSeed(bytes.data(), bytes.size(),
                                                XXH3_128bits(shape.data(), sizeof shape).low64);
        EXPECT_EQ(texture.facts.texelHash[0], hash.low64) << name;
        EXPECT_EQ(texture.facts.texelHash[1], hash.high64) << name;
    }
}

TEST_F(Mips, TwoBakesAreTheSameBytes) {
    std::vector<float> values;
    for (int i = 0; i < 100 * 90 * 3; ++i) values.push_back(static_cast<float>(i % 17) / 16.0f);
    writeTexture(file("a.png"), 100, 90, 3, OIIO::TypeDesc::UINT8, values);
    const auto path = baked({file("a.png")}).file;
    const std::string first = readBytes(path);
    std::filesystem::remove_all(cacheFolder());
    EXPECT_EQ(baked({file("a.png")}).file, path);
    EXPECT_EQ(readBytes(path), first);
}

// Of an OpenEXR file of one part: the bytes after the header, where the table of the tiles begins.
std::size_t endOfHeader(const std::string& bytes) {
    std::size_t at = 8;
    while (at < bytes.size() && bytes[at] != '\0') {
        at = bytes.find('\0', bytes.find('\0', at) + 1) + 1;  // past name and type
        std::uint32_t size{};
        std::memcpy(&size, &bytes[at], sizeof size);
        at += sizeof size + size;
    }
    return at + 1;
}

// Without it a reader has to walk through all tiles each time that it opens the file.
TEST_F(Mips, TheFileSaysWhereItsTilesAre) {
    const std::vector<float> values(std::size_t{200} * 70, 0.5f);
    writeTexture(file("a.png"), 200, 70, 1, OIIO::TypeDesc::UINT8, values);
    const std::string bytes = readBytes(baked({file("a.png")}).file);
    const std::size_t table = endOfHeader(bytes);
    constexpr std::size_t kTiles = 4 * 2 + 2 + 6;  // 200 x 70, 100 x 35, then one each
    for (std::size_t i = 0; i < kTiles; ++i) {
        std::uint64_t offset{};
        ASSERT_LE(table + 8 * i + 8, bytes.size());
        std::memcpy(&offset, &bytes[table + 8 * i], sizeof offset);
        EXPECT_GE(offset, table + 8 * kTiles) << "tile " << i;
        EXPECT_LT(offset, bytes.size()) << "tile " << i;
    }
}

// One texture has all threads: rows are read ahead of those that are written.
TEST_F(Mips, ThreadsMakeTheSameBytes) {
    std::vector<float> values;
    for (int i = 0; i < 90 * 300 * 3; ++i) values.push_back(static_cast<float>(i % 241) / 240.0f);
    writeTexture(file("a.png"), 90, 300, 3, OIIO::TypeDesc::UINT8, values);
    std::vector<std::string> made;
    for (const std::uint32_t threads : {1u, 2u}) {
        std::filesystem::remove_all(cacheFolder());
        TexturePreparer preparing(m_colour, cache(), {threads, std::uint64_t{1} << 30}, {});
        made.push_back(readBytes(preparing.texture({file("a.png")}).file));
    }
    EXPECT_EQ(made[0], made[1]);
    const auto levels = readLevels(baked({file("a.png")}).file);
    EXPECT_NEAR(levels[0].values.back(), std::pow((values.back() + 0.055) / 1.055, 2.4), 0.01);
}

}  // namespace
}  // namespace pm::host::test
