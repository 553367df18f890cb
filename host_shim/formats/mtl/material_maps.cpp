// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/formats/mtl/material_maps.h"

namespace pm::host {

namespace fs = std::filesystem;

MaterialMap readMap(const std::string& text, const fs::path& folder, bool isData,
                    SceneFiles& files) {
    MaterialMap map;
    map.line = parseMapLine(
        text, [&](std::string_view name) { return files.find(folder, name).has_value(); });
    if (map.line.name.empty()) return map;
    const auto found = files.find(folder, map.line.name);
    map.isMissing = !found;
    TextureUse& use = map.use;
    use.file = found ? found->string() : (folder / map.line.name).string();
    use.colourSpace = isData ? "" : map.line.colourSpace;
    use.isData = isData;
    use.clamp = map.line.clamp;
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
