// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "host_shim/check/pairs.h"
#include "host_shim/check/region_spread.h"
#include "host_shim/check/render_facts.h"

namespace pm::host {

// Why a reference was made or renewed, the last one last.
struct Reason {
    std::string because, date, version;  // date: YYYY-MM-DD, UTC
};

// What other seeds make of a display picture.
struct DisplayNoise {
    std::vector<RegionSpread> codes;  // of 255; or none
    std::int64_t visibleLimit{};      // pixels visibly different
};

// What lies beside a reference picture, NAME.json: what other seeds make of the scene.
struct Reference {
    std::vector<Reason> reasons;
    PixelRect window;                   // of the picture
    std::vector<RegionSpread> regions;  // of the scene-linear picture
    double pixelLimit{};                // standard errors, told by both pictures
    DisplayNoise display;               // of the display picture, if there is one
    std::map<std::string, DisplayNoise> views;
    // What references of an earlier version don't have.
    std::optional<PairSpread> pairs;
    std::optional<SceneInputs> inputs;
    std::optional<std::vector<std::string>> warnings;
};

// The sides of the regions that are compared: 16 pixels, and the whole picture.
inline constexpr std::int32_t kRegionSides[] = {16, 0};

// The relative change of one region that is found in a render of the reference's seed, median of
// the regions: of 8 pixels by pairs where there are any, else of 16.
double seenChange(const Reference& reference);

// Errors: kFile when it can't be read; kBadInput when it is no reference, with what is wrong.
Reference readReference(const std::filesystem::path& file);
// The file's text; bytes of a reason that are no UTF-8 are replaced.
std::string textOf(const Reference& reference);

}  // namespace pm::host
