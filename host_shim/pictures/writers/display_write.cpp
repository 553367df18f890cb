// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include <OpenImageIO/strutil.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "host_shim/pictures/image_output.h"
#include "host_shim/pictures/writers/picture_format.h"

namespace pm::host {
namespace {

void checkOptions(const std::filesystem::path& path, const DisplayPicture& picture,
                  const DisplayWriteOptions& options, const DisplayFormat& format) {
    const bool wide = format.holds16Bits();
    if (options.bitDepth != 8 && !(options.bitDepth == 16 && wide)) {
        throw HostError(ExitCode::kUsage,
                        fmt::format("{}: {} bits a channel; allowed are {}", path.string(),
                                    options.bitDepth, wide ? "8 and 16" : "8"));
    }
    const auto pixels =
        static_cast<std::size_t>(picture.width) * static_cast<std::size_t>(picture.height);
    const bool shape = picture.width > 0 && picture.height > 0 &&
                       (picture.channels == 3 || picture.channels == 4) &&
                       picture.values.size() == pixels * static_cast<std::size_t>(picture.channels);
    if (!shape) {
        throw HostError(
            ExitCode::kInternal,
            fmt::format("{}: {} values for {} x {} pixels of {} channels", path.string(),
                        picture.values.size(), picture.width, picture.height, picture.channels));
    }
}

// Drops the alpha by laying the picture over black.
DisplayPicture overBlack(const DisplayPicture& picture) {
    DisplayPicture opaque{picture.width, picture.height, 3, {}};
    opaque.values.reserve(picture.values.size() / 4 * 3);
    for (std::size_t i = 0; i < picture.values.size(); i += 4) {
        const float alpha = picture.values[i + 3];
        for (std::size_t c = 0; c < 3; ++c) opaque.values.push_back(picture.values[i + c] * alpha);
    }
    return opaque;
}

template <typename Code>
std::vector<Code> quantize(const std::vector<float>& values, float largest) {
    std::vector<Code> codes(values.size());
    std::ranges::transform(values, codes.begin(), [largest](float value) {
        return static_cast<Code>(codeOf(value, largest));
    });
    return codes;
}

OIIO::ImageSpec makeSpec(const DisplayPicture& picture, const DisplayWriteOptions& options,
                         const DisplayFormat& format) {
    const OIIO::TypeDesc type =
        options.bitDepth == 16 ? OIIO::TypeDesc::UINT16 : OIIO::TypeDesc::UINT8;
    OIIO::ImageSpec spec(picture.width, picture.height, picture.channels, type);
    // Else the writer takes the colours for premultiplied and divides them by alpha.
    if (picture.channels == 4) spec.attribute("oiio:UnassociatedAlpha", 1);
    format.describe(options, spec);
    if (!options.exposure.empty())
        spec.attribute("ImageDescription", "pm:exposure " + options.exposure);
    return spec;
}

// Errors: kInternal for one that is scene-linear.
const DisplayFormat& displayFormat(const std::filesystem::path& path) {
    const auto* format = dynamic_cast<const DisplayFormat*>(&pictureFormat(path));
    if (format == nullptr) {
        throw HostError(ExitCode::kInternal,
                        path.string() + ": a display-referred picture is never written as EXR");
    }
    return *format;
}

}  // namespace

void writeDisplayPicture(const std::filesystem::path& path, const DisplayPicture& given,
                         const DisplayWriteOptions& options) {
    const DisplayFormat& format = displayFormat(path);
    checkOptions(path, given, options, format);
    const bool drop = given.channels == 4 && !format.holdsAlpha();
    const DisplayPicture opaque = drop ? overBlack(given) : DisplayPicture{};
    const DisplayPicture& picture = drop ? opaque : given;
    const auto spec = makeSpec(picture, options, format);
    writeImage(path, spec, [&](OIIO::ImageOutput& output) {
        if (options.bitDepth == 16) {
            const auto codes = quantize<std::uint16_t>(picture.values, 65535.0f);
            return output.write_image(OIIO::TypeDesc::UINT16, codes.data());
        }
        const auto codes = quantize<std::uint8_t>(picture.values, 255.0f);
        return output.write_image(OIIO::TypeDesc::UINT8, codes.data());
    });
}

std::string pngDataUri(const DisplayPicture& picture) {
    const std::filesystem::path name = "picture.png";  // of which only the format is used
    checkOptions(name, picture, {}, pngFormat());
    const auto codes = quantize<std::uint8_t>(picture.values, 255.0f);
    OIIO::Filesystem::IOVecOutput memory;
    const auto output = OIIO::ImageOutput::create(name.string());
    bool good = output && output->set_ioproxy(&memory);
    good = good && output->open(name.string(), makeSpec(picture, {}, pngFormat()));
    good = good && output->write_image(OIIO::TypeDesc::UINT8, codes.data());
    if (output) good = output->close() && good;
    if (!good) {
        throw HostError(ExitCode::kInternal, "a PNG can't be encoded: " +
                                                 (output ? output->geterror() : OIIO::geterror()));
    }
    const auto& bytes = memory.buffer();
    return "data:image/png;base64," +
           OIIO::Strutil::base64_encode(
               {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

}  // namespace pm::host
