// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "host_shim/pictures/picture.h"

namespace pm::host {

// Values of options. Every error is kUsage and says option, value and what is allowed. Numbers have
// a dot in any locale.

// orElse: what is allowed besides, as " or auto".
double numberValue(const std::string& option, std::string_view text, double low, double high,
                   const std::string& orElse = {});
std::int64_t integerValue(const std::string& option, std::string_view text, std::int64_t low,
                          std::int64_t high);
std::array<double, 2> sunValue(const std::string& option, std::string_view text);          // AZ,EL
std::array<double, 3> pointValue(const std::string& option, std::string_view text);        // x,y,z
std::array<std::int32_t, 2> sizeValue(const std::string& option, std::string_view text);   // WxH
std::array<std::int32_t, 2> pixelValue(const std::string& option, std::string_view text);  // X,Y
PixelRect cropValue(const std::string& option, std::string_view text);  // x0,y0,x1,y1

// What fills the patterns in names of files.
struct FrameNumber {
    std::optional<std::int64_t> number;
    bool isFilled{};  // it was, and what looks like a pattern is none
};

// Fills #### (padded to as many digits as there are) and %d, %04d in the last component of the name
// of a file that is written, never in its folders; in an address #### and %04d, wherever they are.
// Without a frame a file of that very name is meant. Errors: kUsage for a pattern when no frame is
// given and there is no such file.
std::string withFrame(const std::string& option, const std::string& name, const FrameNumber& frame);
// The same of what is read: a file or folder of that very name wins, with a frame too.
std::string withFrameOfInput(const std::string& option, const std::string& name,
                             const FrameNumber& frame);

}  // namespace pm::host
