// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "host_shim/formats/mtl/mtl_dialect.h"
#include "host_shim/formats/obj/obj_text.h"
#include "host_shim/formats/scene_data.h"
#include "host_shim/formats/scene_files.h"
#include "host_shim/formats/warnings.h"

namespace pm::host {

struct MaterialLibrary {
    std::vector<MaterialData> materials;
    std::vector<MaterialFile> files;  // that were read
};

// Where libraries are looked for, and how they are read.
struct LibrarySource {
    std::string sceneName;  // for messages
    std::filesystem::path folder;
    std::optional<DialectChoice> asked;    // for all of them; none: by their headers,
    std::optional<DialectChoice> ofScene;  // and by that of the scene where they have none
    std::vector<std::string> alsoWanted;   // names of materials that no face uses
    MemoryNote takes;
};

// Reads the libraries of a scene and answers with one material for each name of
// text.materialNames, in their order, then those of source.alsoWanted that a library has, and the
// default material last. Errors: what goOn throws.
MaterialLibrary loadMaterials(const ObjText& text, const LibrarySource& source, SceneFiles& files,
                              const WarningSink& warn, const GoOn& goOn = {});

}  // namespace pm::host
