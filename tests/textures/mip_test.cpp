// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/textures/row_halver.h"
#include "tests/textures/texture_support.h"

#include <xxhash.h>

#include <cmath>
#include <numeric>

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

}  // namespace
}  // namespace pm::host::test
