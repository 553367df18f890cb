// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "plugin/textures/held_tiles.h"

#include <OpenImageIO/imagecache.h>

#include <algorithm>
#include <bit>
#include <cstring>

namespace pm::plugin {

namespace {

// Of codes of 8 bits, as the division gives them.
const std::array<float, 256> kByteValues = [] {
    std::array<float, 256> values{};
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<float>(i) / 255.0f;
    return values;
}();

// IEEE 754's binary16.
float fromHalf(std::uint16_t half) {
    const auto bits = std::uint32_t{half};
    const std::uint32_t sign = (bits & 0x8000u) << 16, exponent = bits & 0x7c00u;
    constexpr std::uint32_t kBias = (127u - 15u) << 23;
    std::uint32_t magnitude = (bits & 0x7fffu) << 13;
    if (exponent == 0x7c00u)
        magnitude |= 0x7f800000u;
    else if (exponent != 0)
        magnitude += kBias;
    else  // subnormal
        magnitude = std::bit_cast<std::uint32_t>(static_cast<float>(bits & 0x3ffu) * 0x1p-24f);
    return std::bit_cast<float>(sign | magnitude);
}

float fromByte(std::uint8_t code) {
    return kByteValues[code];
}
float fromWord(std::uint16_t code) {
    return static_cast<float>(code) / 65535.0f;
}

template <typename Code, std::size_t kChannels, typename Convert>
void convertTexel(const std::byte* texels, std::size_t index, TexelValues& values,
                  const Convert& convert) {
    std::array<Code, kChannels> codes;
    std::memcpy(codes.data(), texels + index * sizeof codes, sizeof codes);
    values = {};
    for (std::size_t i = 0; i < kChannels; ++i) values[i] = convert(codes[i]);
}

// index: of the texel in its tile. With the number of channels known the compiler copies by
// registers.
template <typename Code, typename Convert>
void convertTexel(const std::byte* texels, std::size_t index, std::int32_t channels,
                  TexelValues& values, const Convert& convert) {
    switch (channels) {
        case 1:
            return convertTexel<Code, 1>(texels, index, values, convert);
        case 2:
            return convertTexel<Code, 2>(texels, index, values, convert);
        case 3:
            return convertTexel<Code, 3>(texels, index, values, convert);
        default:
            return convertTexel<Code, 4>(texels, index, values, convert);
    }
}

std::uint64_t placeOf(std::size_t level, std::int32_t column, std::int32_t row) {
    return std::uint64_t{level} << 48 | std::uint64_t{static_cast<std::uint32_t>(row)} << 24 |
           static_cast<std::uint32_t>(column);
}

std::size_t bytesOf(const TextureLevel& level, const TextureFile& file, std::size_t perChannel) {
    return static_cast<std::size_t>(level.tileWidth) * static_cast<std::size_t>(level.tileHeight) *
           static_cast<std::size_t>(file.channels) * perChannel;
}

}  // namespace

void HeldTiles::release(Slot& slot) {
    if (slot.tile) m_cache.release_tile(static_cast<OIIO::ImageCache::Tile*>(slot.tile));
    m_bytes -= slot.bytes;
    slot = {};
}

void HeldTiles::release() {
    for (Slot& slot : m_slots) release(slot);
}

bool HeldTiles::read(const TextureFile& file, std::size_t level, std::int32_t column,
                     std::int32_t row, Slot& slot) {
    const TextureLevel& of = file.levels[level];
    OIIO::ImageCache::Tile* const tile = m_cache.get_tile(
        static_cast<OIIO::ImageCache::ImageHandle*>(file.handle), m_cache.get_perthread_info(), 0,
        static_cast<int>(level), of.fileX + column * of.tileWidth, of.fileY + row * of.tileHeight,
        0, 0, file.channels);
    if (!tile) {
        m_cache.geterror();  // or the texts pile up
        return false;
    }
    OIIO::TypeDesc type;
    slot.tile = tile;
    slot.texels = static_cast<const std::byte*>(m_cache.tile_pixels(tile, type));
    slot.format = type == OIIO::TypeDesc::UINT8    ? Format::kByte
                  : type == OIIO::TypeDesc::UINT16 ? Format::kWord
                  : type == OIIO::TypeDesc::HALF   ? Format::kHalf
                                                   : Format::kFloat;
    return slot.texels != nullptr;
}

const HeldTiles::Slot* HeldTiles::tile(const TextureFile& file, std::size_t level,
                                       std::int32_t column, std::int32_t row) {
    const std::uint64_t place = placeOf(level, column, row);
    // Neighbours, and the same place of other levels and pictures, lie in slots of their own.
    const auto hash = static_cast<std::size_t>(column) + 17 * static_cast<std::size_t>(row) +
                      71 * level + 151 * static_cast<std::size_t>(file.number);
    Slot& slot = m_slots[hash % kSlots];
    if (slot.file == file.number && slot.place == place) return &slot;
    const std::size_t bytes = bytesOf(file.levels[level], file, sizeof(float));
    if (m_bytes + bytes > m_allowance.load(std::memory_order_relaxed)) release();
    release(slot);
    if (!read(file, level, column, row, slot)) {
        release(slot);
        return nullptr;
    }
    slot.file = file.number;
    slot.place = place;
    slot.bytes = bytes;
    m_bytes += bytes;
    return &slot;
}

bool HeldTiles::four(const TextureFile& file, std::size_t level, std::array<std::int32_t, 2> x,
                     std::array<std::int32_t, 2> y, std::array<TexelValues, 4>& texels) {
    const TextureLevel& of = file.levels[level];
    const Slot* slot = nullptr;
    std::int32_t column = -1, row = -1;
    for (std::size_t i = 0; i < 4; ++i) {
        const std::int32_t dx = x[i & 1] - of.dataX, dy = y[i >> 1] - of.dataY;
        if (dx < 0 || dx >= of.dataWidth || dy < 0 || dy >= of.dataHeight) {
            texels[i] = {};
            continue;
        }
        if (!slot || of.columnOf(dx) != column || of.rowOf(dy) != row) {
            column = of.columnOf(dx);
            row = of.rowOf(dy);
            slot = tile(file, level, column, row);
            if (!slot) return false;
        }
        const std::int32_t inX = dx - column * of.tileWidth, inY = dy - row * of.tileHeight;
        const auto index = static_cast<std::size_t>(inY * of.tileWidth + inX);
        switch (slot->format) {
            case Format::kByte:
                convertTexel<std::uint8_t>(slot->texels, index, file.channels, texels[i], fromByte);
                break;
            case Format::kWord:
                convertTexel<std::uint16_t>(slot->texels, index, file.channels, texels[i],
                                            fromWord);
                break;
            case Format::kHalf:
                convertTexel<std::uint16_t>(slot->texels, index, file.channels, texels[i],
                                            fromHalf);
                break;
            case Format::kFloat:
                convertTexel<float>(slot->texels, index, file.channels, texels[i],
                                    [](float value) { return value; });
        }
    }
    return true;
}

}  // namespace pm::plugin
