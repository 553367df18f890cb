// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/pictures/display_compare.h"

#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imagebufalgo.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "host_shim/pictures/compare.h"
#include "host_shim/pictures/picture_input.h"
#include "host_shim/pictures/picture_io.h"

namespace pm::host {
namespace {

constexpr float kFullCode = 255.0f;

DisplayPicture threeChannels(const std::vector<float>& values, std::size_t channels,
                             DisplayPicture result) {
    const bool isGrey = channels < 3, hasAlpha = channels == 2 || channels == 4;
    result.channels = 3;
    result.values.reserve(values.size() / channels * 3);
    for (std::size_t at = 0; at < values.size(); at += channels) {
        const float alpha = hasAlpha ? values[at + channels - 1] : 1.0f;
        for (std::size_t c = 0; c < 3; ++c)
            result.values.push_back(values[at + (isGrey ? 0 : c)] * alpha);
    }
    return result;
}

OIIO::ImageBuf bufferOf(const DisplayPicture& picture) {
    const OIIO::ImageSpec spec(picture.width, picture.height, 3, OIIO::TypeDesc::FLOAT);
    OIIO::ImageBuf buffer(spec);
    buffer.set_pixels(OIIO::ROI::All(), OIIO::TypeDesc::FLOAT, picture.values.data());
    return buffer;
}

std::int64_t visiblePixels(const DisplayPicture& reference, const DisplayPicture& picture) {
    const OIIO::ImageBuf a = bufferOf(reference), b = bufferOf(picture);
    OIIO::ImageBufAlgo::CompareResults result;
    return OIIO::ImageBufAlgo::compare_Yee(a, b, result);
}

}  // namespace

DisplayPicture readDisplayPicture(const std::filesystem::path& path) {
    // Alpha is straight in what pm writes; left as it is in the file.
    OIIO::ImageSpec config;
    config.attribute("oiio:UnassociatedAlpha", 1);
    const auto input = openPicture(path, config);
    const OIIO::ImageSpec spec = input->spec();
    if (spec.nchannels > 4 || spec.nchannels < 1)
        refusePicture(path, fmt::format("{} channels; allowed are 1 to 4", spec.nchannels));
    const auto channels = static_cast<std::size_t>(spec.nchannels);
    return threeChannels(readValues(path, *input), channels, {spec.width, spec.height, 3, {}});
}

DisplayPicture asCodes(const DisplayPicture& picture) {
    DisplayPicture result = picture;
    for (float& value : result.values) value = codeOf(value, kFullCode) / kFullCode;
    return result;
}

DisplayDifference compareDisplay(const DisplayPicture& reference, const DisplayPicture& picture) {
    checkSameSize(reference.width, reference.height, picture.width, picture.height);
    if (reference.channels != 3 || picture.channels != 3)
        throw HostError(ExitCode::kInternal, "display pictures are compared by three channels");
    DisplayDifference result;
    double squares = 0, sum = 0;
    for (std::size_t i = 0; i < picture.values.size(); ++i) {
        const double codes = std::abs(static_cast<double>(picture.values[i]) -
                                      static_cast<double>(reference.values[i])) *
                             static_cast<double>(kFullCode);
        squares += codes * codes;
        sum += codes;
        if (codes <= result.most) continue;
        const auto pixel = static_cast<std::int32_t>(i / 3);
        result.most = codes;
        result.x = pixel % picture.width;
        result.y = pixel / picture.width;
        result.channel = static_cast<int>(i % 3);
    }
    const auto count = static_cast<double>(picture.values.size());
    result.rms = std::sqrt(squares / count);
    result.mean = sum / count;
    result.visiblePixels = visiblePixels(reference, picture);
    return result;
}

std::string describe(const DisplayDifference& difference) {
    return fmt::format(
        "rms {:.3g}, at most {:.3g} of 255 ({} at {},{}), {} pixels visibly different",
        difference.rms, difference.most, "RGB"[difference.channel], difference.x, difference.y,
        difference.visiblePixels);
}

}  // namespace pm::host
