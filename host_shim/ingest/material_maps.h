// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include "host_shim/ingest/scene_data.h"

#include <tiny_obj_loader.h>

#include <filesystem>
#include <optional>
#include <string>

namespace pm::host {

// Map lines of materials: picture names as they can be opened, and their options.
class MapReader {
  public:
    explicit MapReader(std::filesystem::path folder) : m_folder(std::move(folder)) {}

    // None when the name is empty.
    std::optional<TextureUse> read(const std::string& name,
                                   const tinyobj::texture_option_t& options, bool isData) const;

  private:
    std::string locate(std::string name) const;

    std::filesystem::path m_folder;
};

}  // namespace pm::host
