// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string_view>
#include <utility>
#include <vector>

namespace pm::host {

// What OpenImageIO can't do in an EXR file of one part with tiles of one level, once it is closed.
// Source: OpenEXR's "File Layout".

// Sets an attribute of the type int. Errors: HostError kFile.
void setExrNumber(const std::filesystem::path& file, std::string_view name, std::int32_t value);

// Gives tiles that were not written the bytes of others, which a writer would compress anew, each
// time to the same. copies: places of a tile without bytes and of one with them, row by row; both
// of one size. columns: tiles in a row. Errors: HostError kFile.
void copyExrTiles(const std::filesystem::path& file, std::size_t columns,
                  const std::vector<std::pair<std::size_t, std::size_t>>& copies);

}  // namespace pm::host
