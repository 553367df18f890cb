// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "host_shim/formats/scene_data.h"
#include "host_shim/formats/scene_reader.h"
#include "host_shim/formats/warnings.h"

namespace pm::host {

// Reads an OBJ file and its material libraries. Every index is checked; polygons stay polygons.
// Missing libraries, materials and pictures are warned of, not errors.
// goOn: called again and again on the way; what it throws ends the reading; may be empty.
// eye: the camera's place, if it is known; see centreFor.
// Errors: kFile when the file can't be read; kBadInput, "FILE:LINE: what", when it is bad.
SceneData readObjFile(const std::filesystem::path& file, const WarningSink& warn,
                      const GoOn& goOn = {}, const std::optional<std::array<double, 3>>& eye = {},
                      const ReadRules& rules = {});

// The same from text; fileName is for messages, folder is where libraries and pictures are.
SceneData readObj(std::string_view text, const std::string& fileName,
                  const std::filesystem::path& folder, const WarningSink& warn,
                  const GoOn& goOn = {}, const std::optional<std::array<double, 3>>& eye = {},
                  const ReadRules& rules = {});

// The same behind the interface of all readers.
class ObjReader : public SceneReader {
  public:
    std::string_view name() const override { return "an OBJ file"; }
    std::span<const std::string_view> endings() const override;
    SceneData read(const ReadRequest& request) const override;
};

}  // namespace pm::host
