// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>

#include "host_shim/pictures/picture.h"

namespace pm::host {

// A PNG, JPEG or TIFF as fractions of full code; with alpha it is laid over black, and one channel
// is grey. Errors: kFile when it can't be opened; kBadInput when it is no such picture or broken.
DisplayPicture readDisplayPicture(const std::filesystem::path& path);

// As a file of 8 bits holds it: codes of 255ths, clamped, NaN as 0.
DisplayPicture asCodes(const DisplayPicture& picture);

// How two display pictures of one size differ. Codes are of 255.
struct DisplayDifference {
    double rms{}, mean{};  // over all values; mean of the absolute difference
    double most{};         // the largest, and where
    std::int32_t x{}, y{};
    int channel{};  // 0 to 2
    // Pixels whose difference an eye sees, by Hector Yee's measure (OpenImageIO's compare_Yee at
    // 100 cd/m2 and 45 degrees across the picture; of OpenImageIO 2.4 it is by hue and saturation
    // alone).
    std::int64_t visiblePixels{};
};

// Errors: kBadInput when they are not of one size; kInternal when either is not of three channels.
DisplayDifference compareDisplay(const DisplayPicture& reference, const DisplayPicture& picture);

// "rms 0.31, at most 4 of 255 (G at 12,40), 0 pixels visibly different".
std::string describe(const DisplayDifference& difference);

}  // namespace pm::host
