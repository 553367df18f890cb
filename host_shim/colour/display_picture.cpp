// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/colour/display_picture.h"

#include <algorithm>
#include <array>

#include "host_shim/values/host_error.h"

namespace pm::host {
namespace {

const Channel& required(const Picture& picture, const char* name) {
    const Channel* channel = picture.find(name);
    if (channel != nullptr) return *channel;
    throw HostError(ExitCode::kInternal,
                    std::string("a picture without channel ") + name + " can't be displayed");
}

}  // namespace

DisplayResult makeDisplayPicture(const Picture& picture, const DisplayTransform& transform,
                                 bool withAlpha) {
    const std::array<const Channel*, 3> colour{&required(picture, "R"), &required(picture, "G"),
                                               &required(picture, "B")};
    const Channel* alpha = withAlpha ? picture.find("A") : nullptr;
    DisplayResult result;
    DisplayPicture& shown = result.picture;
    shown.width = picture.dataWindow.width();
    shown.height = picture.dataWindow.height();
    shown.channels = alpha != nullptr ? 4 : 3;
    const auto pixels = static_cast<std::size_t>(picture.dataWindow.area());
    shown.values.reserve(pixels * static_cast<std::size_t>(shown.channels));
    for (std::size_t i = 0; i < pixels; ++i) {
        const float coverage = alpha != nullptr ? alpha->values[i] : 1.0f;
        // Light without coverage (a glow beside an object) keeps its colour.
        const float divisor = coverage > 0.0f ? coverage : 1.0f;
        for (const Channel* channel : colour) shown.values.push_back(channel->values[i] / divisor);
        if (alpha != nullptr) shown.values.push_back(std::clamp(coverage, 0.0f, 1.0f));
    }
    result.cleaning = transform.apply(shown.values, shown.channels);
    return result;
}

}  // namespace pm::host
