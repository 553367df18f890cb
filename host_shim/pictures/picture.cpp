// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/pictures/picture.h"

#include <algorithm>

namespace pm::host {

bool isColourChannelName(std::string_view name) {
    const auto dot = name.rfind('.');
    const std::string_view last = dot == std::string_view::npos ? name : name.substr(dot + 1);
    return last == "R" || last == "G" || last == "B" || last == "A";
}

const Channel* Picture::find(std::string_view name) const {
    const auto found = std::find_if(channels.begin(), channels.end(),
                                    [&](const Channel& c) { return c.name == name; });
    return found == channels.end() ? nullptr : &*found;
}

}  // namespace pm::host
