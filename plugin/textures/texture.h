// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "plugin/textures/texture_system.h"

namespace pm::plugin {

// One of the pictures that each fill a square of uv (UDIM); its uvOffset puts it there.
struct TextureTile {
    std::uint32_t number;  // 1001 + column + 10 row
    TexturePicture picture;
};

// A picture with the cache that it is read through, or several as tiles.
struct Texture {
    std::shared_ptr<TextureSystem> system;
    TexturePicture picture;          // of tiles the largest
    std::vector<TextureTile> tiles;  // by growing numbers; empty: the picture is all there is

    // The picture at uv; null where there is no tile.
    const TexturePicture* at(Vec2f uv) const;
};

}  // namespace pm::plugin
