// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "host_shim/colour/transfer_curve.h"

namespace pm::host {

// What a picture file says of its colours.
struct PictureStatement {
    std::vector<std::string> spaces{};  // names of colour spaces, the surest first
    // Of codes, not floats: the light that they stand for.
    std::optional<TransferCurve> curve{};
    // x,y of red, green, blue, white, of that light; none of codes: Rec.709's.
    std::optional<std::array<float, 8>> chromaticities{};
    bool isXyz{};           // CIE XYZ, D65's white at luminance 1
    std::string profile{};  // description of an embedded ICC profile
};

}  // namespace pm::host
