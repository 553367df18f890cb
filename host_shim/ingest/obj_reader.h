// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include "host_shim/ingest/scene_data.h"
#include "host_shim/ingest/warnings.h"

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace pm::host {

// Reads an OBJ file and its material libraries. Every index is checked; polygons stay polygons.
// Missing libraries, materials and pictures are warned of, not errors.
// goOn: called again and again on the way; what it throws ends the reading; may be empty.
// eye: the camera's place, if it is known; see centreFor.
// Errors: kFile when the file can't be read; kBadInput, "FILE:LINE: what", when it is bad.
SceneData readObjFile(const std::filesystem::path& file, const WarningSink& warn,
                      const GoOn& goOn = {}, const std::optional<std::array<double, 3>>& eye = {});

// The same from text; fileName is for messages, folder is where libraries and pictures are.
SceneData readObj(std::string_view text, const std::string& fileName,
                  const std::filesystem::path& folder, const WarningSink& warn,
                  const GoOn& goOn = {}, const std::optional<std::array<double, 3>>& eye = {});

// Errors: kFile when the file can't be opened for reading, kBadInput when it is a folder.
void checkSceneFile(const std::filesystem::path& file);

// A file as a whole. Errors: kFile, with the system's reason.
std::string readWholeFile(const std::filesystem::path& file);

}  // namespace pm::host
