// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>

#include "host_shim/colour/space_conversion.h"
#include "host_shim/pictures/checked_file.h"
#include "host_shim/textures/picture_rows.h"
#include "host_shim/textures/texture_facts.h"

namespace pm::host {

// How a picture becomes a texture, known from its header and the conversion.
class TextureBake {
  public:
    // rows: nothing of it has been read. kind as it was opened with.
    TextureBake(PictureRows& rows, TextureKind kind, const SpaceConversion& conversion);

    // Bytes that baking holds at most.
    std::uint64_t memoryBytes() const;
    // Whether the file itself can be the texture, unless some texel of it is bad.
    bool needsNoConversion() const;
    // Looks at all texels of such a file. False, with nothing in facts, where some are bad; then a
    // new TextureBake of new rows bakes it.
    bool inspect(const std::function<void()>& goOn, TextureFacts& facts);
    // Writes the texture to `file`, whose name is `path`: tiled, mip-mapped, in the rendering
    // space, converted before any filtering, in half (8-bit colour, and half where nothing is
    // converted) or float, so that nothing is clipped. Grey that stays grey and numbers have one
    // channel, colours three. threads: with two or more, rows are read ahead by another thread; the
    // file is the same. goOn: called every few rows; may throw. Errors: HostError kBadInput
    // when the picture is broken, kFile when the texture can't be written; the text names `rows`'
    // file or shownName.
    TextureFacts bake(CheckedFile& file, const std::filesystem::path& path,
                      const std::filesystem::path& shownName, int threads,
                      const std::function<void()>& goOn);

  private:
    bool isHalf(float largest) const;

    PictureRows& m_rows;
    TextureKind m_kind;
    bool m_isColour;
    SpaceConversion m_conversion;
};

}  // namespace pm::host
