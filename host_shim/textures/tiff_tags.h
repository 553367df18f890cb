// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>
#include <filesystem>

namespace pm::host {

inline constexpr std::uint16_t kTiffBitsPerSample = 258;

// Whether the first directory of a TIFF, of either byte order, BigTIFF too, has an entry of that
// tag. True where the directory can't be read: whoever reads the picture tells.
bool hasTiffTag(const std::filesystem::path& file, std::uint16_t tag);

}  // namespace pm::host
