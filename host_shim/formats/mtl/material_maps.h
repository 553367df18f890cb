// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <filesystem>
#include <string>

#include "host_shim/formats/mtl/map_line.h"
#include "host_shim/formats/scene_data.h"
#include "host_shim/formats/scene_files.h"

namespace pm::host {

// A map line of a material, and the picture as it can be opened.
struct MaterialMap {
    MapLine line;
    TextureUse use;
    // The picture was not found, or may not be opened. A use that is kept all the same is for the
    // message of who tries to open it.
    bool isMissing{};
};

// text: options and name as they stand. isData: never converted between colour spaces.
MaterialMap readMap(const std::string& text, const std::filesystem::path& folder, bool isData,
                    SceneFiles& files);

}  // namespace pm::host
