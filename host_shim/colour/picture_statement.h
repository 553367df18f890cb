// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace pm::host {

// What a picture file says of its colours.
struct PictureStatement {
    std::vector<std::string> spaces{};  // names of colour spaces, the surest first
    std::optional<std::array<float, 8>> chromaticities{};  // x,y of red, green, blue, white; linear
    bool isXyz{};                                          // CIE XYZ, D65's white at luminance 1
    std::string profile{};  // description of an embedded ICC profile, which is not obeyed
};

}  // namespace pm::host
