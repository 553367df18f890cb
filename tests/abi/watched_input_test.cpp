// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Reads of textures that a thread's watch is told of, and that are those of the library itself.
#include "plugin/textures/watched_input.h"

#include <OpenImageIO/imagecache.h>
#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "integrator/caches/cache_watch.h"

namespace pm::plugin::test {
namespace {

constexpr int kSide = 256, kTile = 64, kChannels = 4;

struct Told : CacheWatch {
    std::vector<CacheAsked> all;
    void asked(const CacheAsked& what) override { all.push_back(what); }
};

// With an alpha that is not multiplied in yet, which the reader of TIFF does while it converts.
std::string pictureOf(const char* name, bool isTiled) {
    const std::string file = testing::TempDir() + name;
    OIIO::ImageSpec spec(kSide, kSide, kChannels, OIIO::TypeDesc::UINT8);
    if (isTiled) spec.tile_width = spec.tile_height = kTile;
    spec.attribute("oiio:UnassociatedAlpha", 1);
    std::vector<std::uint8_t> texels(std::size_t{kChannels} * kSide * kSide);
    for (std::size_t i = 0; i < texels.size(); ++i)
        texels[i] = static_cast<std::uint8_t>(i * 2654435761u >> 20);
    const auto out = OIIO::ImageOutput::create("tiff");
    EXPECT_TRUE(out->open(file, spec) && out->write_image(OIIO::TypeDesc::UINT8, texels.data()) &&
                out->close());
    return file;
}

std::vector<float> texelsOf(const std::string& file, bool isWatched) {
    OIIO::ImageCache* const cache = OIIO::ImageCache::create(false);
    cache->attribute("autotile", kTile);
    const OIIO::ustring name(file);
    if (isWatched) {
        EXPECT_TRUE(cache->add_file(name, makeWatchedInput));
    }
    std::vector<float> texels(std::size_t{kChannels} * kSide * kSide);
    EXPECT_TRUE(cache->get_pixels(name, 0, 0, 0, kSide, 0, kSide, 0, 1, OIIO::TypeDesc::FLOAT,
                                  texels.data()))
        << cache->geterror();
    OIIO::ImageCache::destroy(cache);
    return texels;
}

class WatchedInput : public testing::TestWithParam<bool> {};

TEST_P(WatchedInput, TellsOfEachReadOnce) {
    const std::string file = pictureOf(GetParam() ? "tiled.tif" : "rows.tif", GetParam());
    const std::vector<float> texels = texelsOf(file, false);
    Told told;
    {
        const CacheWatch::Scope scope(&told);
        const CacheWatch::As as(CacheUser::kGather);
        EXPECT_EQ(texelsOf(file, true), texels);
    }
    // A tile, or a strip of rows as high as one.
    constexpr std::size_t kAcross = kSide / kTile;
    EXPECT_EQ(told.all.size(), GetParam() ? kAcross * kAcross : kAcross);
    std::uint64_t bytes = 0;
    for (const CacheAsked& what : told.all) {
        EXPECT_EQ(what.cache, texelCache());
        EXPECT_EQ(what.user, CacheUser::kGather);
        EXPECT_TRUE(what.missed);
        bytes += what.bytes;
    }
    EXPECT_EQ(bytes, texels.size());
    EXPECT_EQ(texelsOf(file, true), texels) << "nobody watches";
    std::filesystem::remove(file);
}

INSTANTIATE_TEST_SUITE_P(Both, WatchedInput, testing::Bool());

TEST(WatchedInputs, AFileThatIsNoneIsRefused) {
    OIIO::ImageCache* const cache = OIIO::ImageCache::create(false);
    EXPECT_FALSE(cache->add_file(OIIO::ustring("/no/such.tif"), makeWatchedInput));
    EXPECT_NE(cache->geterror().find("/no/such.tif"), std::string::npos);
    OIIO::ImageCache::destroy(cache);
}

}  // namespace
}  // namespace pm::plugin::test
