// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <OpenImageIO/imageio.h>

#include <filesystem>
#include <vector>

namespace pm::host::test {

// Writes values (interleaved) as a file of that type; straight alpha where there are 4 channels.
inline void writeTexture(const std::filesystem::path& path, int width, int height, int channels,
                         OIIO::TypeDesc type, const std::vector<float>& values) {
    OIIO::ImageSpec spec(width, height, channels, type);
    if (channels == 2 || channels == 4) spec.attribute("oiio:UnassociatedAlpha", 1);
    const auto output = OIIO::ImageOutput::create(path.string());
    output->open(path.string(), spec);
    output->write_image(OIIO::TypeDesc::FLOAT, values.data());
    output->close();
}

struct Level {
    OIIO::ImageSpec spec;
    std::vector<float> values;
};

// Every mip level as it lies in the file.
inline std::vector<Level> readLevels(const std::filesystem::path& path) {
    std::vector<Level> levels;
    const auto input = OIIO::ImageInput::open(path.string());
    for (int i = 0; input && input->seek_subimage(0, i); ++i) {
        Level level{input->spec(), {}};
        level.values.resize(level.spec.image_pixels() *
                            static_cast<std::size_t>(level.spec.nchannels));
        input->read_image(0, i, 0, -1, OIIO::TypeDesc::FLOAT, level.values.data());
        levels.push_back(std::move(level));
    }
    return levels;
}

}  // namespace pm::host::test
