// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include "host_shim/ingest/obj_text.h"
#include "host_shim/ingest/scene_data.h"
#include "host_shim/ingest/warnings.h"

#include <filesystem>
#include <string>
#include <vector>

namespace pm::host {

struct MaterialLibrary {
    std::vector<MaterialData> materials;
    std::vector<std::string> files;  // that were read
};

// Reads the libraries of a scene and answers with one material for each name of
// text.materialNames, in their order, and the default material after them.
MaterialLibrary loadMaterials(const ObjText& text, const std::string& fileName,
                              const std::filesystem::path& folder, const WarningSink& warn);

}  // namespace pm::host
