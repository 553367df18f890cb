// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "plugin/textures/texture.h"

#include <algorithm>
#include <cmath>

namespace pm::plugin {

const TexturePicture* Texture::at(Vec2f uv) const {
    if (tiles.empty()) return &picture;
    const float column = std::floor(uv.x * picture.uvScale.x + picture.uvOffset.x);
    const float row = std::floor(uv.y * picture.uvScale.y + picture.uvOffset.y);
    constexpr float kColumns = 10, kRows = 900;
    if (!(column >= 0 && column < kColumns && row >= 0 && row < kRows)) return nullptr;
    const auto number =
        1001 + static_cast<std::uint32_t>(column) + 10 * static_cast<std::uint32_t>(row);
    const auto found = std::ranges::lower_bound(tiles, number, {}, &TextureTile::number);
    return found != tiles.end() && found->number == number ? &found->picture : nullptr;
}

}  // namespace pm::plugin
