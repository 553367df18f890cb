// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/formats/mtl/material_maps.h"

namespace pm::host {

namespace fs = std::filesystem;

namespace {

constexpr std::string_view kUdim = "<UDIM>";

bool hasTiles(std::string_view name) {
    return name.find(kUdim) != std::string_view::npos;
}

std::vector<TileUse> findTiles(const std::string& name, const fs::path& folder, SceneFiles& files) {
    constexpr std::uint32_t kFirst = 1001, kLast = 1999;
    std::vector<TileUse> tiles;
    for (std::uint32_t number = kFirst; number <= kLast; ++number) {
        std::string one = name;
        one.replace(one.find(kUdim), kUdim.size(), std::to_string(number));
        if (const auto found = files.find(folder, one)) tiles.push_back({number, found->string()});
    }
    return tiles;
}

}  // namespace

MaterialMap readMap(const std::string& text, const fs::path& folder, bool isData,
                    SceneFiles& files) {
    MaterialMap map;
    map.line = parseMapLine(text, [&](std::string_view name) {
        return files.find(folder, name).has_value() ||
               (hasTiles(name) && !findTiles(std::string(name), folder, files).empty());
    });
    if (map.line.name.empty()) return map;
    const auto found = files.find(folder, map.line.name);
    TextureUse& use = map.use;
    if (!found && hasTiles(map.line.name)) use.tiles = findTiles(map.line.name, folder, files);
    map.isMissing = !found && use.tiles.empty();
    use.file = found ? found->string() : (folder / map.line.name).string();
    use.colourSpace = isData ? "" : map.line.colourSpace;
    use.isData = isData;
    use.clamp = map.line.clamp;
    // Of one number: colours have three.
    if (isData)
        use.channel = map.line.channel;
    else if (map.line.channel != '\0')
        map.line.leftOut.emplace_back("-imfchan");
    for (std::size_t axis = 0; axis < 2; ++axis) {
        use.scale[axis] = static_cast<float>(map.line.scale[axis]);
        use.offset[axis] = static_cast<float>(map.line.offset[axis]);
    }
    use.base = static_cast<float>(map.line.base);
    use.gain = static_cast<float>(map.line.gain);
    use.strength = static_cast<float>(map.line.strength);
    return map;
}

}  // namespace pm::host
