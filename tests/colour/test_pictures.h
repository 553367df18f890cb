// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <string>
#include <vector>

#include "host_shim/pictures/picture.h"

namespace pm::host::test {

// A picture whose value at pixel i of its channel c is 0.25 c + 0.5 i / pixels, alpha 1.
inline Picture gradientPicture(std::int32_t width, std::int32_t height, const PixelRect& window,
                               const std::vector<std::string>& names = {"R", "G", "B", "A"}) {
    Picture picture{width, height, window, {}, {}};
    for (std::size_t c = 0; c < names.size(); ++c) {
        Channel channel{names[c], isColourChannelName(names[c]), {}};
        for (std::int64_t i = 0; i < window.area(); ++i) {
            channel.values.push_back(names[c] == "A" ? 1.0f
                                                     : 0.25f * static_cast<float>(c) +
                                                           0.5f * static_cast<float>(i) /
                                                               static_cast<float>(window.area()));
        }
        picture.channels.push_back(std::move(channel));
    }
    return picture;
}

inline Picture gradientPicture(std::int32_t width, std::int32_t height) {
    return gradientPicture(width, height, {0, 0, width, height});
}

}  // namespace pm::host::test
