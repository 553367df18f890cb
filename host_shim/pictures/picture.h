// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace pm::host {

// Half-open rectangle of pixels [x0,x1) x [y0,y1); origin top left, y down, in the display window.
// Coordinates may be negative (overscan).
struct PixelRect {
    std::int32_t x0{}, y0{}, x1{}, y1{};

    std::int32_t width() const { return x1 - x0; }
    std::int32_t height() const { return y1 - y0; }
    bool empty() const { return x1 <= x0 || y1 <= y0; }
    std::int64_t area() const {
        return empty() ? 0 : static_cast<std::int64_t>(width()) * height();
    }
    friend bool operator==(const PixelRect&, const PixelRect&) = default;
};

// One plane of floats over the data window, rows from the top.
struct Channel {
    std::string name;  // as in the file: R, direct.G, N.X, Z
    bool isColour{};   // may be stored as half; data never is
    std::vector<float> values;
};

// True for a channel that holds colour or coverage by its name: R, G, B, A or one ending .R, .G,
// .B, .A. Data never ends so.
bool isColourChannelName(std::string_view name);

// OpenEXR has no 64-bit integer that survives: give those as text.
using AttributeValue = std::variant<std::int32_t, float, std::string, std::vector<float>>;
using Attributes = std::map<std::string, AttributeValue>;

// A scene-linear picture as an EXR file holds it. Colour is premultiplied by the coverage A.
struct Picture {
    std::int32_t width{}, height{};  // display window [0,width) x [0,height)
    PixelRect dataWindow;            // may exceed the display window
    std::vector<Channel> channels;
    Attributes attributes;  // chromaticities (8 floats), colorInteropID, pm:...

    const Channel* find(std::string_view name) const;  // nullptr when there is none
};

// The code of a display value, of codes from 0 to `largest`: clamped, NaN as 0.
inline float codeOf(float value, float largest) {
    // The comparison is false for NaN.
    const float clamped = value > 0.0f ? std::min(value, 1.0f) : 0.0f;
    return std::floor(clamped * largest + 0.5f);
}

// A picture as a display shows it: fractions of full code in [0,1], rows from the top.
struct DisplayPicture {
    std::int32_t width{}, height{};
    std::int32_t channels{3};   // 3, or 4 with straight (unassociated) alpha last
    std::vector<float> values;  // interleaved
};

}  // namespace pm::host
