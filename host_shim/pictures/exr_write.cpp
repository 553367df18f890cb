// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/pictures/image_output.h"
#include "host_shim/pictures/picture_io.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace pm::host {
namespace {

constexpr float kLargestHalf = 65504.0f;
// Scanlines given to the writer at once; a multiple of the 16 that ZIP packs together.
constexpr std::int32_t kLinesAtOnce = 64;

void checkPicture(const std::filesystem::path& path, const Picture& picture) {
    const auto fail = [&](const std::string& text) {
        throw HostError(ExitCode::kInternal, fmt::format("{}: {}", path.string(), text));
    };
    if (picture.width < 1 || picture.height < 1 || picture.dataWindow.empty()) {
        fail(fmt::format("a picture of {} x {} pixels with {} x {} of data can't be written",
                         picture.width, picture.height, picture.dataWindow.width(),
                         picture.dataWindow.height()));
    }
    if (picture.channels.empty()) fail("a picture without channels can't be written");
    std::set<std::string> names;
    for (const Channel& channel : picture.channels) {
        if (!names.insert(channel.name).second) fail("two channels named " + channel.name);
        if (static_cast<std::int64_t>(channel.values.size()) != picture.dataWindow.area()) {
            fail(fmt::format("channel {} has {} values for a data window of {}", channel.name,
                             channel.values.size(), picture.dataWindow.area()));
        }
    }
}

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

OIIO::ImageSpec makeSpec(const Picture& picture, bool halfColour) {
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
        spec.channelformats.push_back(halfColour && channel.isColour ? OIIO::TypeDesc::HALF
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

// Interleaves the lines [first,last) of the data window.
std::vector<float> interleave(const Picture& picture, std::int32_t first, std::int32_t last,
                              bool halfColour, std::int64_t& clamped) {
    const auto width = static_cast<std::size_t>(picture.dataWindow.width());
    const std::size_t count = picture.channels.size();
    const std::size_t begin = static_cast<std::size_t>(first) * width;
    const std::size_t end = static_cast<std::size_t>(last) * width;
    std::vector<float> line((end - begin) * count);
    for (std::size_t c = 0; c < count; ++c) {
        const Channel& channel = picture.channels[c];
        const bool half = halfColour && channel.isColour;
        for (std::size_t i = begin; i < end; ++i) {
            float value = channel.values[i];
            if (half && std::isfinite(value) && std::fabs(value) > kLargestHalf) {
                value = std::copysign(kLargestHalf, value);
                ++clamped;
            }
            line[(i - begin) * count + c] = value;
        }
    }
    return line;
}

}  // namespace

ExrReport writeExr(const std::filesystem::path& path, const Picture& picture,
                   const ExrOptions& options) {
    checkPicture(path, picture);
    ExrReport report;
    writeImage(path, makeSpec(picture, options.halfColour), [&](OIIO::ImageOutput& output) {
        const std::int32_t height = picture.dataWindow.height();
        for (std::int32_t first = 0; first < height; first += kLinesAtOnce) {
            const std::int32_t last = std::min(height, first + kLinesAtOnce);
            const auto lines =
                interleave(picture, first, last, options.halfColour, report.clampedToHalf);
            const std::int32_t top = picture.dataWindow.y0;
            if (!output.write_scanlines(top + first, top + last, 0, OIIO::TypeDesc::FLOAT,
                                        lines.data())) {
                return false;
            }
        }
        return true;
    });
    return report;
}

}  // namespace pm::host
