// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include "host_shim/pictures/picture_input.h"
#include "host_shim/pictures/picture_io.h"

namespace pm::host {
namespace {

std::unique_ptr<OIIO::ImageInput> openExr(const std::filesystem::path& path) {
    auto input = openPicture(path, {});
    if (std::string(input->format_name()) != "openexr") {
        refusePicture(path, fmt::format("is {}; an OpenEXR file is needed", input->format_name()));
    }
    return input;
}

void readAttributes(const OIIO::ImageSpec& spec, Attributes& attributes) {
    for (const OIIO::ParamValue& value : spec.extra_attribs) {
        const std::string name = value.name().string();
        const OIIO::TypeDesc type = value.type();
        if (name.starts_with("oiio:")) continue;  // OpenImageIO's own, not of the file
        if (type == OIIO::TypeInt) {
            attributes[name] = value.get<std::int32_t>();
        } else if (type == OIIO::TypeFloat) {
            attributes[name] = value.get<float>();
        } else if (type == OIIO::TypeString) {
            attributes[name] = value.get_string();
        } else if (type.basetype == OIIO::TypeDesc::FLOAT) {
            const auto* first = static_cast<const float*>(value.data());
            attributes[name] = std::vector<float>(first, first + type.basevalues());
        }
    }
}

}  // namespace

Picture readExr(const std::filesystem::path& path) {
    const auto input = openExr(path);
    const OIIO::ImageSpec spec = input->spec();
    if (spec.full_x != 0 || spec.full_y != 0) {
        refusePicture(path, fmt::format("its display window begins at {},{}; allowed is 0,0",
                                        spec.full_x, spec.full_y));
    }
    Picture picture;
    picture.width = spec.full_width;
    picture.height = spec.full_height;
    picture.dataWindow = {spec.x, spec.y, spec.x + spec.width, spec.y + spec.height};
    readAttributes(spec, picture.attributes);
    const auto count = static_cast<std::size_t>(spec.nchannels);
    const auto pixels = static_cast<std::size_t>(picture.dataWindow.area());
    const std::vector<float> values = readValues(path, *input);
    for (std::size_t c = 0; c < count; ++c) {
        Channel channel{spec.channelnames[c], isColourChannelName(spec.channelnames[c]), {}};
        channel.values.resize(pixels);
        for (std::size_t i = 0; i < pixels; ++i) channel.values[i] = values[i * count + c];
        picture.channels.push_back(std::move(channel));
    }
    return picture;
}

}  // namespace pm::host
