// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/render/picture_alpha.h"

#include <algorithm>
#include <map>
#include <string>

#include "host_shim/textures/picture_kind.h"

namespace pm::host {

void takeAlphaOfPictures(std::span<MaterialData> materials) {
    std::map<std::string, bool> known;  // many materials share a picture
    const auto isCut = [&](const std::string& file) {
        const auto [at, isNew] = known.try_emplace(file);
        if (isNew) at->second = hasAlpha(file);
        return at->second;
    };
    for (MaterialData& material : materials) {
        if (!material.diffuseTexture || material.opacityTexture) continue;
        TextureUse use = *material.diffuseTexture;
        const bool isWhole = use.tiles.empty()
                                 ? isCut(use.file)
                                 : std::ranges::all_of(use.tiles, [&](const TileUse& tile) {
                                       return isCut(tile.file);
                                   });
        if (!isWhole) continue;
        use.isData = true;
        use.colourSpace.clear();
        use.channel = 0;
        use.base = 0;
        use.gain = use.missing = 1;
        material.opacityTexture = use;
    }
}

}  // namespace pm::host
