// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/ingest/material_maps.h"

#include "host_shim/ingest/file_names.h"
#include "host_shim/ingest/text_lines.h"

#include <algorithm>

namespace pm::host {

namespace fs = std::filesystem;

std::optional<TextureUse> MapReader::read(const std::string& name,
                                          const tinyobj::texture_option_t& options,
                                          bool isData) const {
    if (trimmed(name).empty()) return std::nullopt;
    TextureUse use;
    use.file = locate(std::string(trimmed(name)));
    use.colourSpace = isData ? "" : options.colorspace;
    use.isData = isData;
    use.clamp = options.clamp;
    for (std::size_t axis = 0; axis < 2; ++axis) {
        use.scale[axis] = static_cast<float>(options.scale[axis]);
        use.offset[axis] = static_cast<float>(options.origin_offset[axis]);
    }
    use.base = static_cast<float>(options.brightness);
    use.gain = static_cast<float>(options.contrast);
    return use;
}

// Beside the library; else only its last part, for absolute names of the machine where the scene
// was made. A name that is not found is returned as it stands, for the message.
std::string MapReader::locate(std::string name) const {
    if (const auto found = findFile(m_folder, name)) return found->string();
    const fs::path first = m_folder / name;
    std::ranges::replace(name, '\\', '/');
    const auto found = findFile(m_folder, fs::path(name).filename().string());
    return found ? found->string() : first.string();
}

}  // namespace pm::host
