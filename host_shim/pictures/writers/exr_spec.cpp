// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/pictures/writers/exr_spec.h"

#include <cmath>

#include "host_shim/pictures/image_output.h"

namespace pm::host {
namespace {

constexpr float kLargestHalf = 65504.0f;

struct SetAttribute {
    OIIO::ImageSpec& spec;
    const std::string& name;
    void operator()(std::int32_t value) const { spec.attribute(name, value); }
    void operator()(float value) const { spec.attribute(name, value); }
    void operator()(const std::string& value) const { spec.attribute(name, value); }
    void operator()(const std::vector<float>& values) const {
        const OIIO::TypeDesc type(OIIO::TypeDesc::FLOAT, static_cast<int>(values.size()));
        spec.attribute(name, type, values.data());
    }
};

}  // namespace

OIIO::ImageSpec exrSpec(const Picture& picture, bool halfColour) {
    const PixelRect& window = picture.dataWindow;
    OIIO::ImageSpec spec(window.width(), window.height(), static_cast<int>(picture.channels.size()),
                         OIIO::TypeDesc::FLOAT);
    spec.x = window.x0;
    spec.y = window.y0;
    spec.full_x = spec.full_y = 0;
    spec.full_width = picture.width;
    spec.full_height = picture.height;
    spec.channelnames.clear();
    for (std::size_t i = 0; i < picture.channels.size(); ++i) {
        const Channel& channel = picture.channels[i];
        spec.channelnames.push_back(channel.name);
        // Formats by channel have OpenImageIO copy all pixels once more.
        if (halfColour)
            spec.channelformats.push_back(channel.isColour ? OIIO::TypeDesc::HALF
                                                           : OIIO::TypeDesc::FLOAT);
        if (channel.name == "A") spec.alpha_channel = static_cast<int>(i);
        if (channel.name == "Z") spec.z_channel = static_cast<int>(i);
    }
    spec.attribute("compression", "zip");
    spec.attribute("DateTime", kFixedDateTime);
    for (const auto& [name, value] : picture.attributes) {
        std::visit(SetAttribute{spec, name}, value);
    }
    return spec;
}

float clampedToHalf(float value, std::int64_t& clamped) {
    if (!std::isfinite(value) || std::fabs(value) <= kLargestHalf) return value;
    ++clamped;
    return std::copysign(kLargestHalf, value);
}

}  // namespace pm::host
