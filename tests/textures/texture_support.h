// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <OpenImageIO/imageio.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "host_shim/textures/texture_preparation.h"
#include "tests/colour/scratch.h"

namespace pm::host::test {

// Writes values (interleaved) as a file of that spec.
inline void writePicture(const std::filesystem::path& path, const OIIO::ImageSpec& spec,
                         const std::vector<float>& values) {
    const auto output = OIIO::ImageOutput::create(path.string());
    ASSERT_TRUE(output) << path;
    ASSERT_TRUE(output->open(path.string(), spec)) << output->geterror();
    ASSERT_TRUE(output->write_image(OIIO::TypeDesc::FLOAT, values.data())) << output->geterror();
    ASSERT_TRUE(output->close());
}

// The same with channels of the usual names; straight alpha where there are 2 or 4.
inline void writeTexture(const std::filesystem::path& path, int width, int height, int channels,
                         OIIO::TypeDesc type, const std::vector<float>& values) {
    OIIO::ImageSpec spec(width, height, channels, type);
    if (channels == 2) spec.channelnames = {"Y", "A"};
    if (channels == 2) spec.alpha_channel = 1;
    if (channels == 2 || channels == 4) spec.attribute("oiio:UnassociatedAlpha", 1);
    writePicture(path, spec, values);
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
    OIIO::geterror();
    return levels;
}

// Textures are kept in the test's own folder.
class TextureTest : public ScratchTest {
  protected:
    std::filesystem::path cacheFolder() const { return file("cache"); }
    std::shared_ptr<TextureCache> cache(std::uint64_t limitBytes = std::uint64_t{1} << 40) const {
        return std::make_shared<TextureCache>(cacheFolder(), limitBytes);
    }
    TexturePreparer preparer(std::function<void()> goOn = {}) const {
        return {m_colour, cache(), {2, std::uint64_t{1} << 30}, std::move(goOn)};
    }
    BakedTexture baked(const TextureRequest& request) const { return preparer().texture(request); }
    // Texels of the finest level.
    std::vector<float> texels(const TextureRequest& request) const {
        const auto levels = readLevels(baked(request).file);
        return levels.empty() ? std::vector<float>{} : levels[0].values;
    }

    ColourPipeline m_colour{ColourOptions{}};
};

}  // namespace pm::host::test
