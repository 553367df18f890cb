// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "host_shim/check/region_spread.h"

namespace pm::host {

// Why a reference was made or renewed, the last one last.
struct Reason {
    std::string because, date, version;  // date: YYYY-MM-DD, UTC
};

// What lies beside a reference picture, NAME.json: what other seeds make of the scene.
struct Reference {
    std::vector<Reason> reasons;
    PixelRect window;                   // of the picture
    std::vector<RegionSpread> regions;  // of the scene-linear picture
    std::vector<RegionSpread> codes;    // of the display picture, in codes of 255; or none
    double pixelLimit{};                // standard errors, told by both pictures
    std::int64_t visibleLimit{};        // pixels visibly different
};

// The sides of the regions that are compared: 16 pixels, and the whole picture.
inline constexpr std::int32_t kRegionSides[] = {16, 0};

// Errors: kFile when it can't be read; kBadInput when it is no reference, with what is wrong.
Reference readReference(const std::filesystem::path& file);
// The file's text; bytes of a reason that are no UTF-8 are replaced.
std::string textOf(const Reference& reference);

}  // namespace pm::host
