// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "host_shim/pictures/image_output.h"
#include "host_shim/pictures/writers/exr_spec.h"
#include "host_shim/pictures/writers/picture_format.h"

namespace pm::host {
namespace {

// Scanlines given to the writer at once: a multiple of the 16 that ZIP packs together, and so many
// that all threads have some to pack; of wide pictures fewer, for the memory.
constexpr std::int32_t kLeastLines = 64, kMostLines = 1024;
constexpr std::int64_t kValuesAtOnce = std::int64_t{1} << 22;

std::int32_t linesAtOnce(const Picture& picture) {
    const std::int64_t ofLine = std::int64_t{picture.dataWindow.width()} *
                                static_cast<std::int64_t>(picture.channels.size());
    return static_cast<std::int32_t>(
        std::clamp<std::int64_t>(kValuesAtOnce / ofLine / 16 * 16, kLeastLines, kMostLines));
}

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

// Interleaves the lines [first,last) of the data window.
std::vector<float> interleave(const Picture& picture, std::int32_t first, std::int32_t last,
                              bool halfColour, std::int64_t& clamped) {
    const auto width = static_cast<std::size_t>(picture.dataWindow.width());
    const std::size_t count = picture.channels.size();
    const std::size_t begin = static_cast<std::size_t>(first) * width;
    const std::size_t end = static_cast<std::size_t>(last) * width;
    std::vector<float> line((end - begin) * count);
    // A line at a time, which stays in the core's cache for all channels.
    for (std::size_t at = begin; at < end; at += width) {
        for (std::size_t c = 0; c < count; ++c) {
            const Channel& channel = picture.channels[c];
            const bool half = halfColour && channel.isColour;
            for (std::size_t i = at; i < at + width; ++i) {
                const float value = channel.values[i];
                line[(i - begin) * count + c] = half ? clampedToHalf(value, clamped) : value;
            }
        }
    }
    return line;
}

class Exr : public LinearFormat {
  public:
    std::span<const std::string_view> endings() const override {
        static constexpr std::string_view kEndings[] = {".exr"};
        return kEndings;
    }
    ExrReport write(const std::filesystem::path& path, const Picture& picture,
                    const ExrOptions& options) const override {
        return writeExr(path, picture, options);
    }
};

}  // namespace

const LinearFormat& exrFormat() {
    static const Exr kFormat;
    return kFormat;
}

ExrReport writeExr(const std::filesystem::path& path, const Picture& picture,
                   const ExrOptions& options) {
    checkPicture(path, picture);
    ExrReport report;
    writeImage(path, exrSpec(picture, options.halfColour), [&](OIIO::ImageOutput& output) {
        const std::int32_t height = picture.dataWindow.height(), step = linesAtOnce(picture);
        for (std::int32_t first = 0; first < height; first += step) {
            const std::int32_t last = std::min(height, first + step);
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
