// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/ingest/material_maps.h"

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

// As it stands, beside the library; else with the slashes of another system; else only its last
// part, for absolute names of the machine where the scene was made. A name that none of them finds
// is returned as the first of them, for the message.
std::string MapReader::locate(std::string name) const {
    std::error_code error;
    const fs::path first = m_folder / name;
    if (fs::exists(first, error)) return first.string();
    std::ranges::replace(name, '\\', '/');
    for (const fs::path& candidate : {m_folder / name, m_folder / fs::path(name).filename()}) {
        if (fs::exists(candidate, error)) return candidate.string();
    }
    return first.string();
}

}  // namespace pm::host
