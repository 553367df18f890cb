// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace pm::host {

// What a map line of an MTL file says behind its key.
struct MapLine {
    std::string name;  // of the picture, as it stands; empty where there is none
    std::array<double, 3> scale{1, 1, 1};
    std::array<double, 3> offset{};
    double base{0};
    double gain{1};
    double strength{1};  // of a normal map or heights
    bool clamp{};
    std::string colourSpace;
    char channel{};                    // of -imfchan: r g b l z, or 0
    std::vector<std::string> leftOut;  // options that ask for something that is not done
};

// Options stand before the name or after it. A name may hold blanks and dashes: where it isn't
// clear where it ends, the first reading of which isFile says that it is one counts, else the
// shortest name. No errors.
MapLine parseMapLine(std::string_view text, const std::function<bool(std::string_view)>& isFile);

}  // namespace pm::host
