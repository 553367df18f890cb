// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/colour/texture_read.h"

#include "host_shim/colour/host_error.h"

#include <OpenImageIO/imageio.h>

#include <fmt/format.h>

namespace pm::host {
namespace {

std::unique_ptr<OIIO::ImageInput> openTexture(const std::filesystem::path& file) {
    std::error_code failed;
    if (!std::filesystem::is_regular_file(file, failed)) {
        const bool there = std::filesystem::exists(file, failed);
        throw HostError(ExitCode::kFile, fmt::format("texture {} {}", file.string(),
                                                     there ? "is not a file" : "does not exist"));
    }
    // Else OpenImageIO multiplies sRGB-coded values by alpha, in the code's curve.
    OIIO::ImageSpec wishes;
    wishes.attribute("oiio:UnassociatedAlpha", 1);
    auto input = OIIO::ImageInput::open(file.string(), &wishes);
    if (!input) {
        throw HostError(ExitCode::kBadInput,
                        fmt::format("texture {} can't be read as a picture: {}", file.string(),
                                    OIIO::geterror()));
    }
    return input;
}

// Divides colours that the file holds multiplied by alpha. Where alpha is 0 nothing is known.
void makeStraight(TextureImage& image) {
    const auto channels = static_cast<std::size_t>(image.channels);
    const auto alpha = static_cast<std::size_t>(image.alphaChannel);
    for (std::size_t i = 0; i + channels <= image.values.size(); i += channels) {
        const float coverage = image.values[i + alpha];
        if (!(coverage > 0.0f)) continue;
        for (std::size_t c = 0; c < channels; ++c) {
            if (c != alpha) image.values[i + c] /= coverage;
        }
    }
}

}  // namespace

TextureImage readTexture(const std::filesystem::path& file, bool keepAlphaAside) {
    const auto input = openTexture(file);
    const OIIO::ImageSpec spec = input->spec();
    TextureImage image;
    image.width = spec.width;
    image.height = spec.height;
    image.channels = std::min(spec.nchannels, 4);
    if (image.width < 1 || image.height < 1 || image.channels < 1) {
        throw HostError(ExitCode::kBadInput,
                        fmt::format("texture {} has no pixels", file.string()));
    }
    image.isFloatFile = spec.format.is_floating_point();
    image.is8Bit = spec.format == OIIO::TypeDesc::UINT8;
    if (keepAlphaAside && spec.alpha_channel < image.channels) {
        image.alphaChannel = spec.alpha_channel;
    }
    image.values.resize(static_cast<std::size_t>(image.width) *
                        static_cast<std::size_t>(image.height) *
                        static_cast<std::size_t>(image.channels));
    const bool good =
        input->read_image(0, 0, 0, image.channels, OIIO::TypeDesc::FLOAT, image.values.data());
    // A truncated JPEG or TIFF comes back as read, with a text.
    const std::string text = input->geterror();
    if (!good || !text.empty()) {
        throw HostError(ExitCode::kBadInput,
                        fmt::format("texture {} is broken or cut short: {}", file.string(), text));
    }
    const bool straight = spec.get_int_attribute("oiio:UnassociatedAlpha") != 0;
    if (image.alphaChannel >= 0 && !straight) makeStraight(image);
    return image;
}

}  // namespace pm::host
