// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/colour/texture_bake.h"

#include "host_shim/colour/asked_work.h"
#include "host_shim/colour/texture_read.h"
#include "host_shim/pictures/finished_file.h"

#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imagebufalgo.h>

#include <fmt/format.h>

#include <xxhash.h>

#include <algorithm>
#include <cmath>
#include <memory>

namespace pm::host {
namespace {

constexpr int kTileSize = 64;
constexpr float kLargestHalf = 65504.0f;

std::int64_t replaceBadTexels(std::vector<float>& values) {
    std::int64_t count = 0;
    for (float& value : values) {
        if (std::isfinite(value)) continue;
        value = 0.0f;  // one of them would spread over whole mip levels
        ++count;
    }
    return count;
}

// Grey becomes three equal channels, alpha goes last.
void expandToColour(TextureImage& image) {
    const auto from = static_cast<std::size_t>(image.channels);
    const bool hasAlpha = image.alphaChannel >= 0;
    const std::size_t colours = from - (hasAlpha ? 1 : 0);
    const std::size_t to = hasAlpha ? 4 : 3;
    const auto alpha = hasAlpha ? static_cast<std::size_t>(image.alphaChannel) : from;
    std::array<std::size_t, 3> source{};
    std::size_t found = 0;
    for (std::size_t c = 0; c < from && found < 3; ++c) {
        if (c != alpha) source[found++] = c;
    }
    // One or two colour channels: grey is the first.
    if (colours < 3) source = {source[0], source[0], source[0]};
    std::vector<float> values;
    values.reserve(image.values.size() / from * to);
    for (std::size_t i = 0; i < image.values.size(); i += from) {
        for (const std::size_t c : source) values.push_back(image.values[i + c]);
        if (hasAlpha) values.push_back(image.values[i + alpha]);
    }
    image.values = std::move(values);
    image.channels = static_cast<std::int32_t>(to);
    image.alphaChannel = hasAlpha ? 3 : -1;
}

bool fitsHalf(const std::vector<float>& values) {
    return std::all_of(values.begin(), values.end(),
                       [](float value) { return std::fabs(value) <= kLargestHalf; });
}

OIIO::ImageSpec textureSettings(OIIO::TypeDesc format, bool clamp) {
    OIIO::ImageSpec settings;
    settings.set_format(format);
    settings.tile_width = settings.tile_height = kTileSize;
    settings.tile_depth = 1;
    const std::string wrap = clamp ? "clamp,clamp" : "periodic,periodic";
    settings.attribute("wrapmodes", wrap);
    settings.attribute("maketx:fileformatname", "openexr");
    settings.attribute("compression", "zip");
    return settings;
}

// The lowest level is written last, so when its only tile is there, all are.
bool isWhole(const std::filesystem::path& file) {
    const auto input = OIIO::ImageInput::open(file.string());
    if (!input) return false;
    int level = 0;
    while (input->seek_subimage(0, level + 1)) ++level;
    input->geterror();  // the level past the last
    const OIIO::ImageSpec spec = input->spec_dimensions(0, level);
    const auto size = static_cast<std::size_t>(kTileSize) * kTileSize;
    std::vector<float> tile(size * static_cast<std::size_t>(spec.nchannels));
    return spec.width == 1 && spec.height == 1 && input->seek_subimage(0, level) &&
           input->read_tile(spec.x, spec.y, 0, OIIO::TypeDesc::FLOAT, tile.data());
}

void writeTexture(const std::filesystem::path& path, const TextureImage& image,
                  OIIO::TypeDesc format, bool clamp) {
    const OIIO::ImageSpec spec(image.width, image.height, image.channels, OIIO::TypeDesc::FLOAT);
    // ImageBuf wants a writable pointer but make_texture only reads.
    const OIIO::ImageBuf source(spec, const_cast<float*>(image.values.data()));
    FinishedFile finished(path);
    const bool good = OIIO::ImageBufAlgo::make_texture(OIIO::ImageBufAlgo::MakeTxTexture, source,
                                                       finished.temporaryPath().string(),
                                                       textureSettings(format, clamp));
    const std::string text = OIIO::geterror();
    if (!good || !isWhole(finished.temporaryPath())) {
        throw HostError(ExitCode::kFile,
                        fmt::format("texture {}: can't be written: {}", path.string(), text));
    }
    finished.commit();
}

// To the rendering space, before any filtering: a mean of sRGB codes is not the code of the mean.
// Returns how many texels were bad.
std::int64_t convert(TextureImage& image, bool isColour, const SpaceConversion& conversion) {
    const std::int64_t bad = replaceBadTexels(image.values);
    if (!isColour) return bad;
    expandToColour(image);
    conversion.apply(image.values, image.channels);
    return bad + replaceBadTexels(image.values);
}

std::string bakedName(const std::filesystem::path& file, const std::string& key) {
    return fmt::format("{}.{:016x}.tx", file.stem().string(), XXH3_64bits(key.data(), key.size()));
}

}  // namespace

TextureBaker::TextureBaker(const ColourPipeline& colour, std::filesystem::path folder,
                           std::function<void()> goOn)
    : m_colour(colour), m_folder(std::move(folder)), m_goOn(std::move(goOn)) {}

const BakedTexture& TextureBaker::bake(const TextureRequest& request) {
    const bool isColour = request.kind == TextureKind::kColour;
    const std::string source = std::filesystem::absolute(request.file).lexically_normal().string();
    const std::string asked = fmt::format("{}\n{}\n{}\n{}", source, isColour ? "colour" : "data",
                                          isColour ? request.colorspace : "", request.clamp);
    if (const auto found = m_baked.find(asked); found != m_baked.end()) return found->second;

    // Shared with the work that goOn may leave behind: of a large picture each step takes seconds.
    const auto image = std::make_shared<TextureImage>(
        runAsking(m_goOn, [file = request.file, isColour] { return readTexture(file, isColour); }));
    BakedTexture baked;
    SpaceConversion conversion;
    baked.space.isData = !isColour;
    if (isColour) {
        baked.space = m_colour.textureSpace(request.file, image->isFloatFile, request.colorspace);
        conversion = m_colour.textureToRendering(baked.space);
    }
    baked.badTexels = runAsking(
        m_goOn, [image, isColour, conversion] { return convert(*image, isColour, conversion); });
    baked.width = image->width;
    baked.height = image->height;
    baked.channels = image->channels;
    baked.file = m_folder / bakedName(request.file, asked + "\n" + conversion.cacheId());
    callAsking(m_goOn, [image, isColour, file = baked.file, clamp = request.clamp] {
        const bool half = isColour && image->is8Bit && fitsHalf(image->values);
        writeTexture(file, *image, half ? OIIO::TypeDesc::HALF : OIIO::TypeDesc::FLOAT, clamp);
    });
    return m_baked.emplace(asked, std::move(baked)).first->second;
}

}  // namespace pm::host
