// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>

namespace pm::host {

// The chunks of a PNG that say what its codes mean (W3C, Portable Network Graphics,
// section 11.3.3).
struct PngColour {
    std::optional<std::string> profileName{};  // of iCCP
    bool isSrgb{};                             // sRGB
    std::optional<double> gamma{};             // gAMA: the exponent from light to codes
    // cHRM: x,y of red, green, blue, white.
    std::optional<std::array<float, 8>> chromaticities{};
};

// Reads the heads of a PNG's chunks up to its pixels, and what is in those four. What is broken or
// cut short counts as not there.
PngColour readPngColour(const std::filesystem::path& file);

}  // namespace pm::host
