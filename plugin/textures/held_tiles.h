// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <OpenImageIO/oiioversion.h>

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <vector>

OIIO_NAMESPACE_BEGIN
class ImageCache;
OIIO_NAMESPACE_END

namespace pm::plugin {

// A mip level of a picture. Texels are counted from the corner of its display window.
struct TextureLevel {
    std::int32_t width = 1, height = 1;                                // of the display window
    std::int32_t dataX = 0, dataY = 0, dataWidth = 1, dataHeight = 1;  // what there are texels of
    std::int32_t fileX = 0, fileY = 0;  // of the first texel, as the file counts
    std::int32_t tileWidth = 1, tileHeight = 1;

    // Of tiles, in which a texel of the data is.
    std::int32_t columnOf(std::int32_t x) const {
        return tileBitsX >= 0 ? x >> tileBitsX : x / tileWidth;
    }
    std::int32_t rowOf(std::int32_t y) const {
        return tileBitsY >= 0 ? y >> tileBitsY : y / tileHeight;
    }

    std::int32_t tileBitsX = -1, tileBitsY = -1;  // of sides that are powers of two
};

// What look-ups need to know of a picture's file.
struct TextureFile {
    std::uint64_t number = 0;   // no other file's of the same system
    void* handle = nullptr;     // OIIO::ImageCache::ImageHandle, whose header is dear to compile
    std::int32_t channels = 1;  // of a texel in a tile, 1 to 4
    std::vector<TextureLevel> levels;  // finest first
};

// Four channels; those that a picture lacks are 0.
using TexelValues = std::array<float, 4>;

// Tiles that a thread has looked at, held so that the next look-up there asks no cache that all
// threads share. Threads: one.
class HeldTiles {
  public:
    // allowance: bytes to hold, but for the tile that was looked at last; may change.
    HeldTiles(OIIO::ImageCache& cache, const std::atomic<std::size_t>& allowance)
        : m_cache(cache), m_allowance(allowance) {}
    ~HeldTiles() { release(); }
    HeldTiles(const HeldTiles&) = delete;
    HeldTiles& operator=(const HeldTiles&) = delete;

    // The texels (x0 or x1, y0 or y1) of a level: x0 y0, x1 y0, x0 y1, x1 y1. One outside of the
    // data is 0. Returns false when they can't be read.
    bool four(const TextureFile& file, std::size_t level, std::array<std::int32_t, 2> x,
              std::array<std::int32_t, 2> y, std::array<TexelValues, 4>& texels);

  private:
    enum class Format : std::uint8_t { kByte, kWord, kHalf, kFloat };
    struct Slot {
        std::uint64_t file = 0, place = 0;  // file 0: empty
        const std::byte* texels = nullptr;
        void* tile = nullptr;
        std::size_t bytes = 0;
        Format format = Format::kFloat;
    };
    static constexpr std::size_t kSlots = 1024;

    // column, row: of tiles. Null when it can't be read.
    const Slot* tile(const TextureFile& file, std::size_t level, std::int32_t column,
                     std::int32_t row);
    bool read(const TextureFile& file, std::size_t level, std::int32_t column, std::int32_t row,
              Slot& slot);
    void release(Slot& slot);
    void release();

    OIIO::ImageCache& m_cache;
    const std::atomic<std::size_t>& m_allowance;
    std::array<Slot, kSlots> m_slots{};
    std::size_t m_bytes = 0;
};

}  // namespace pm::plugin
