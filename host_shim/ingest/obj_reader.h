// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include "host_shim/ingest/mtl_dialect.h"
#include "host_shim/ingest/scene_data.h"
#include "host_shim/ingest/scene_files.h"
#include "host_shim/ingest/warnings.h"

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace pm::host {

// How the materials of a scene are read, and from which files.
struct MaterialRules {
    std::optional<MtlDialect> dialect;  // of all libraries; none: by their headers
    SceneFileRules files;
};

// Reads an OBJ file and its material libraries. Every index is checked; polygons stay polygons.
// Missing libraries, materials and pictures are warned of, not errors.
// goOn: called again and again on the way; what it throws ends the reading; may be empty.
// eye: the camera's place, if it is known; see centreFor.
// Errors: kFile when the file can't be read; kBadInput, "FILE:LINE: what", when it is bad.
SceneData readObjFile(const std::filesystem::path& file, const WarningSink& warn,
                      const GoOn& goOn = {}, const std::optional<std::array<double, 3>>& eye = {},
                      const MaterialRules& rules = {});

// The same from text; fileName is for messages, folder is where libraries and pictures are.
SceneData readObj(std::string_view text, const std::string& fileName,
                  const std::filesystem::path& folder, const WarningSink& warn,
                  const GoOn& goOn = {}, const std::optional<std::array<double, 3>>& eye = {},
                  const MaterialRules& rules = {});

// Errors: kFile when the file can't be opened for reading, kBadInput when it is a folder.
void checkSceneFile(const std::filesystem::path& file);

// A file as a whole. Errors: kFile, with the system's reason.
std::string readWholeFile(const std::filesystem::path& file);

}  // namespace pm::host
