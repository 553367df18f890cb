// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "tests/bench/run/pictures.h"

#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <cmath>

#include "integrator/values/error.h"

namespace pm::bench {

namespace {

double srgbOf(double linear) {
    const double x = std::clamp(linear, 0.0, 1.0);
    return x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1 / 2.4) - 0.055;
}

double linearOf(double srgb) {
    return srgb <= 0.04045 ? srgb / 12.92 : std::pow((srgb + 0.055) / 1.055, 2.4);
}

void write(const std::filesystem::path& file, const Picture& picture, OIIO::TypeDesc type,
           const void* values) {
    const auto output = OIIO::ImageOutput::create(file.string());
    const OIIO::ImageSpec spec(picture.width, picture.height, 3, type);
    if (!output || !output->open(file.string(), spec) || !output->write_image(type, values) ||
        !output->close())
        throw Error(Status::kIo, file.string() + ": can't be written");
}

}  // namespace

Picture readPicture(const std::filesystem::path& file) {
    const auto input = OIIO::ImageInput::open(file.string());
    if (!input) throw Error(Status::kIo, file.string() + ": " + OIIO::geterror());
    Picture picture{input->spec().width, input->spec().height, {}};
    picture.rgb.resize(3 * static_cast<std::size_t>(picture.width) *
                       static_cast<std::size_t>(picture.height));
    if (input->spec().nchannels < 3 ||
        !input->read_image(0, 0, 0, 3, OIIO::TypeDesc::DOUBLE, picture.rgb.data()))
        throw Error(Status::kIo, file.string() + ": no three channels: " + input->geterror());
    return picture;
}

void writePng(const std::filesystem::path& file, const Picture& picture, double exposure) {
    std::vector<unsigned char> bytes;
    for (const double v : picture.rgb)
        bytes.push_back(static_cast<unsigned char>(255 * srgbOf(v * exposure) + 0.5));
    write(file, picture, OIIO::TypeDesc::UINT8, bytes.data());
}

void writeExr(const std::filesystem::path& file, const Picture& picture) {
    std::vector<float> values;
    for (const double v : picture.rgb) values.push_back(static_cast<float>(v));
    write(file, picture, OIIO::TypeDesc::FLOAT, values.data());
}

Picture differencePicture(const Picture& picture, const Picture& reference, int blur,
                          double scale) {
    Picture result{picture.width, picture.height, std::vector<double>(picture.rgb.size())};
    const auto index = [&](int x, int y, int c) {
        return static_cast<std::size_t>(3 * (y * picture.width + x) + c);
    };
    for (int y = 0; y < picture.height; ++y)
        for (int x = 0; x < picture.width; ++x)
            for (int c = 0; c < 3; ++c) {
                double sum = 0;
                int count = 0;
                for (int v = std::max(0, y - blur); v <= std::min(picture.height - 1, y + blur);
                     ++v)
                    for (int u = std::max(0, x - blur); u <= std::min(picture.width - 1, x + blur);
                         ++u, ++count) {
                        const double r = reference.rgb[index(u, v, c)];
                        sum += (picture.rgb[index(u, v, c)] - r) / std::sqrt(r * r + 0.01);
                    }
                // So that the grey of the PNG is in the middle of its codes.
                result.rgb[index(x, y, c)] =
                    linearOf(std::clamp(0.5 + scale * sum / count, 0.0, 1.0));
            }
    return result;
}

}  // namespace pm::bench
