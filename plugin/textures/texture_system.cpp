// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "plugin/textures/texture_system.h"

#include <OpenImageIO/imagecache.h>
#include <OpenImageIO/imageio.h>
#include <OpenImageIO/texture.h>
#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <new>
#include <vector>

#include "plugin/textures/picture_file.h"
#include "plugin/textures/watched_input.h"
#include "plugin/values/call_error.h"

namespace pm::plugin {

namespace {

// Before a render says: enough to look at all texels once, row after row.
constexpr float kFirstMegabytes = 16.0f;
// Pictures that are not tiled are cut into tiles of this size when they are read.
constexpr int kTilePixels = 64;
// Along a long and narrow footprint; beyond, it is widened.
constexpr int kMostProbes = 16;

OIIO::TextureOpt::Wrap toOpenImageIo(Wrap wrap) {
    switch (wrap) {
        case Wrap::kRepeat:
            break;
        case Wrap::kClamp:
            return OIIO::TextureOpt::WrapClamp;
        case Wrap::kMirror:
            return OIIO::TextureOpt::WrapMirror;
        case Wrap::kBlack:
            return OIIO::TextureOpt::WrapBlack;
    }
    return OIIO::TextureOpt::WrapPeriodic;
}

OIIO::TextureSystem::TextureHandle* handleOf(const TexturePicture& picture) {
    return static_cast<OIIO::TextureSystem::TextureHandle*>(picture.handle);
}

[[noreturn]] void throwUnreadable(const std::string& fileName, const std::string& why) {
    throw CallError(CallStatus::kIo, fmt::format("texture {} can't be read: {}", fileName, why));
}

Texel toTexel(const std::array<float, 4>& values, int channelCount) {
    switch (channelCount) {
        case 1:
            return {values[0], values[0], values[0], 1.0f};
        case 2:
            return {values[0], values[0], values[0], values[1]};
        case 3:
            return {values[0], values[1], values[2], 1.0f};
        default:
            return {values[0], values[1], values[2], values[3]};
    }
}

// Origin upper left, as pictures are stored.
Vec2f placeIn(const TexturePicture& picture, Vec2f uv) {
    return {uv.x * picture.uvScale.x + picture.uvOffset.x,
            1.0f - (uv.y * picture.uvScale.y + picture.uvOffset.y)};
}

// A side of a footprint there; no longer than any texture is looked up over.
Vec2f sideIn(const TexturePicture& picture, const Vec2f& side) {
    static constexpr float kLongest = 1e4f;
    const auto bounded = [](float v) {
        return std::isfinite(v) ? std::clamp(v, -kLongest, kLongest) : kLongest;
    };
    return {bounded(side.x * picture.uvScale.x), bounded(-side.y * picture.uvScale.y)};
}

// Of such footprints the finest level is looked up, and no probes are needed for it.
bool isWithinATexel(const TexturePicture& picture, const Vec2f& side) {
    return std::abs(side.x) * static_cast<float>(picture.width) <= 1.0f &&
           std::abs(side.y) * static_cast<float>(picture.height) <= 1.0f;
}

Texel withGain(const TexturePicture& picture, Texel texel) {
    texel.r = picture.base + picture.gain * texel.r;
    texel.g = picture.base + picture.gain * texel.g;
    texel.b = picture.base + picture.gain * texel.b;
    return texel;
}

struct FreeHash {
    void operator()(XXH3_state_t* state) const { XXH3_freeState(state); }
};

bool isFinite(const Texel& texel) {
    return std::isfinite(texel.r) && std::isfinite(texel.g) && std::isfinite(texel.b) &&
           std::isfinite(texel.a);
}

}  // namespace

std::array<std::uint64_t, 2> texelHash(const std::string& fileName, const CancelCheck& cancel) {
    const std::unique_ptr<OIIO::ImageInput> input = OIIO::ImageInput::open(fileName);
    if (!input) throwUnreadable(fileName, OIIO::geterror());
    const OIIO::ImageSpec& spec = input->spec();
    const std::array<std::int64_t, 4> shape = {spec.width, spec.height, spec.nchannels,
                                               spec.format.basetype};
    const XXH128_hash_t ofShape = XXH3_128bits(shape.data(), sizeof shape);
    const std::unique_ptr<XXH3_state_t, FreeHash> state(XXH3_createState());
    if (!state) throw std::bad_alloc();
    XXH3_128bits_reset_withSeed(state.get(), ofShape.low64);
    // A few rows at a time: the whole may not fit.
    const int step = spec.tile_height > 0 ? spec.tile_height : kTilePixels;
    std::vector<std::byte> texels;
    for (int row = 0; row < spec.height; row += step) {
        cancel.throwIfSet("reading texels");
        const int y0 = spec.y + row, y1 = y0 + std::min(step, spec.height - row);
        texels.resize(static_cast<std::size_t>(y1 - y0) * spec.scanline_bytes(true));
        const bool good =
            spec.tile_width > 0
                ? input->read_tiles(0, 0, spec.x, spec.x + spec.width, y0, y1, 0, 1, 0,
                                    spec.nchannels, OIIO::TypeDesc::UNKNOWN, texels.data())
                : input->read_scanlines(0, 0, y0, y1, 0, 0, spec.nchannels, OIIO::TypeDesc::UNKNOWN,
                                        texels.data());
        if (!good) throwUnreadable(fileName, input->geterror());
        XXH3_128bits_update(state.get(), texels.data(), texels.size());
    }
    const XXH128_hash_t hash = XXH3_128bits_digest(state.get());
    return {hash.low64, hash.high64};
}

TextureSystem::~TextureSystem() {
    if (m_system != nullptr) OIIO::TextureSystem::destroy(m_system);
    // Its texels are given back, but it stays: other threads keep what they last used of it by its
    // address (2.4.7), and a later cache at the same one would be taken for it.
    if (m_cache != nullptr) m_cache->invalidate_all(true);
}

OIIO::TextureSystem& TextureSystem::system() {
    std::call_once(m_once, [this] {
        m_cache = OIIO::ImageCache::create(false);
        OIIO::TextureSystem* made = OIIO::TextureSystem::create(false, m_cache);
        if (made == nullptr) throw CallError(CallStatus::kInternal, "no texture system");
        made->attribute("max_memory_MB", kFirstMegabytes);
        made->attribute("autotile", kTilePixels);
        made->attribute("automip", 0);
        made->attribute("accept_untiled", 1);
        made->attribute("accept_unmipped", 1);
        // Together with autotile it trips an assertion of the library (2.4.7) and ends the process.
        made->attribute("forcefloat", 0);
        made->attribute("unassociatedalpha", 0);
        made->attribute("gray_to_rgb", 0);
        made->attribute("flip_t", 0);
        made->attribute("substitute_image", "");
        made->attribute("searchpath", "");
        m_system = made;
    });
    return *m_system;
}

void TextureSystem::holdAtMost(std::uint64_t bytes) {
    if (bytes == 0) return;
    const std::uint64_t held = std::max(bytes, kLeastBytes);
    system().attribute("max_memory_MB", static_cast<float>(held) / (1024.0f * 1024.0f));
}

TexturePicture TextureSystem::open(const TextureDescription& description) {
    TexturePicture picture;
    picture.fileName = description.fileName;
    picture.wrapS = description.wrapS;
    picture.wrapT = description.wrapT;
    picture.uvScale = description.uvScale;
    picture.uvOffset = description.uvOffset;
    picture.gain = description.gain;
    picture.base = description.base;
    picture.texelHash = description.texelHash;

    checkIsRegularFile(picture.fileName);
    OIIO::TextureSystem& textures = system();
    const OIIO::ustring name(picture.fileName);
    m_cache->add_file(name, makeWatchedInput);
    OIIO::TextureSystem::TextureHandle* const handle = textures.get_texture_handle(name);
    picture.handle = handle;
    std::array<int, 2> size{};
    int format = OIIO::TypeDesc::FLOAT;
    const bool good =
        handle != nullptr && textures.good(handle) &&
        textures.get_texture_info(name, 0, OIIO::ustring("channels"), OIIO::TypeInt,
                                  &picture.channelCount) &&
        textures.get_texture_info(name, 0, OIIO::ustring("format"), OIIO::TypeInt, &format) &&
        textures.get_texture_info(name, 0, OIIO::ustring("resolution"),
                                  OIIO::TypeDesc(OIIO::TypeDesc::INT, 2), size.data());
    std::string reason = m_cache->geterror();
    if (const std::string further = textures.geterror(); reason.empty()) reason = further;
    if (!good || picture.channelCount < 1)
        throw CallError(CallStatus::kIo, fmt::format("texture {}: {}", picture.fileName,
                                                     reason.empty() ? "can't be read" : reason));
    if (format == OIIO::TypeDesc::UINT8) picture.largestCode = 255.0f;
    if (format == OIIO::TypeDesc::UINT16) picture.largestCode = 65535.0f;
    picture.width = static_cast<std::uint32_t>(std::max(1, size[0]));
    picture.height = static_cast<std::uint32_t>(std::max(1, size[1]));
    return picture;
}

bool TextureSystem::lookUp(const TexturePicture& picture, Vec2f uv, const UvFootprint& footprint,
                           Texel& texel) const {
    texel = {0.0f, 0.0f, 0.0f, 0.0f};
    const auto [s, t] = placeIn(picture, uv);
    if (!std::isfinite(s) || !std::isfinite(t)) return false;
    OIIO::TextureOpt options;
    options.swrap = toOpenImageIo(picture.wrapS);
    options.twrap = toOpenImageIo(picture.wrapT);
    options.interpmode = OIIO::TextureOpt::InterpBilinear;
    options.anisotropic = kMostProbes;
    Vec2f dx = sideIn(picture, footprint.x), dy = sideIn(picture, footprint.y);
    options.mipmode = OIIO::TextureOpt::MipModeAniso;
    if (isWithinATexel(picture, dx) && isWithinATexel(picture, dy)) {
        dx = dy = {};
        options.mipmode = OIIO::TextureOpt::MipModeTrilinear;
    }
    const int channelCount = std::min(picture.channelCount, 4);
    std::array<float, 4> values{};
    const bool good = m_system->texture(handleOf(picture), m_system->get_perthread_info(), options,
                                        s, t, dx.x, dx.y, dy.x, dy.y, channelCount, values.data());
    if (!good) {
        m_system->geterror();  // or the texts pile up
        return false;
    }
    const Texel found = withGain(picture, toTexel(values, channelCount));
    if (!isFinite(found)) return false;
    texel = found;
    return true;
}

bool TextureSystem::lookUpOfLight(const TexturePicture& picture, Vec2f uv, Texel& texel) const {
    texel = {0.0f, 0.0f, 0.0f, 0.0f};
    const auto [s, t] = placeIn(picture, uv);
    if (!std::isfinite(s) || !std::isfinite(t)) return false;
    OIIO::TextureOpt options;
    options.swrap = toOpenImageIo(picture.wrapS);
    options.twrap = toOpenImageIo(picture.wrapT);
    options.mipmode = OIIO::TextureOpt::MipModeNoMIP;
    options.interpmode = OIIO::TextureOpt::InterpClosest;
    const auto width = static_cast<float>(picture.width),
               height = static_cast<float>(picture.height);
    const float x = s * width - 0.5f, y = t * height - 0.5f;
    const float x0 = std::floor(x), y0 = std::floor(y);
    const int channelCount = std::min(picture.channelCount, 4);
    for (const float j : {0.0f, 1.0f})
        for (const float i : {0.0f, 1.0f}) {
            std::array<float, 4> values{};
            if (!m_system->texture(handleOf(picture), m_system->get_perthread_info(), options,
                                   (x0 + i + 0.5f) / width, (y0 + j + 0.5f) / height, 0.0f, 0.0f,
                                   0.0f, 0.0f, channelCount, values.data())) {
                m_system->geterror();  // or the texts pile up
                return false;
            }
            const Texel found = withGain(picture, toTexel(values, channelCount));
            const float weight =
                (i > 0 ? x - x0 : 1.0f - (x - x0)) * (j > 0 ? y - y0 : 1.0f - (y - y0));
            const Texel light = asLight(found);
            texel.r += weight * light.r;
            texel.g += weight * light.g;
            texel.b += weight * light.b;
            texel.a += weight * light.a;
        }
    return true;
}

TextureReads& TextureReads::operator+=(const TextureReads& other) {
    tiles += other.tiles;
    bytes += other.bytes;
    tilesOnce += other.tilesOnce;
    bytesOnce += other.bytesOnce;
    texelsOnce += other.texelsOnce;
    return *this;
}

TextureReads TextureSystem::reads(const TexturePicture& picture) const {
    const OIIO::ustring name(picture.fileName);
    const auto count = [&](const char* of) {
        std::int64_t value = 0;
        if (!m_system->get_texture_info(name, 0, OIIO::ustring(of), OIIO::TypeDesc::INT64, &value))
            m_system->geterror();  // or the texts pile up
        return static_cast<std::uint64_t>(std::max<std::int64_t>(value, 0));
    };
    int format = OIIO::TypeDesc::FLOAT;
    m_system->get_texture_info(name, 0, OIIO::ustring("cachedformat"), OIIO::TypeInt, &format);
    TextureReads reads{count("stat:tilesread"), count("stat:bytesread")};
    reads.tilesOnce = reads.tiles - std::min(reads.tiles, count("stat:redundant_tiles"));
    reads.bytesOnce = reads.bytes - std::min(reads.bytes, count("stat:redundant_bytesread"));
    const OIIO::TypeDesc type(static_cast<OIIO::TypeDesc::BASETYPE>(format));
    reads.texelsOnce =
        reads.bytesOnce /
        std::max<std::size_t>(1, type.size() * static_cast<std::size_t>(picture.channelCount));
    return reads;
}

template <typename Visit>
void TextureSystem::forEachTexel(const TexturePicture& picture, const char* what,
                                 const CancelCheck& cancel, const Visit& visit) const {
    constexpr std::uint32_t kRows = kTilePixels;
    const int channelCount = std::min(picture.channelCount, 4);
    const auto channels = static_cast<std::size_t>(channelCount);
    std::vector<float> texels(std::size_t{picture.width} * kRows * channels);
    OIIO::TextureOpt options;
    for (std::uint32_t row = 0; row < picture.height; row += kRows) {
        cancel.throwIfSet(what);
        const std::uint32_t rows = std::min(kRows, picture.height - row);
        if (!m_system->get_texels(handleOf(picture), m_system->get_perthread_info(), options, 0, 0,
                                  static_cast<int>(picture.width), static_cast<int>(row),
                                  static_cast<int>(row + rows), 0, 1, 0, channelCount,
                                  OIIO::TypeDesc::FLOAT, texels.data()))
            throwUnreadable(picture.fileName, m_system->geterror());
        const std::size_t count = std::size_t{picture.width} * rows;
        for (std::size_t i = 0; i < count; ++i) {
            std::array<float, 4> values{};
            std::copy_n(&texels[i * channels], channels, values.begin());
            visit(withGain(picture, toTexel(values, channelCount)));
        }
    }
}

BadTexels TextureSystem::badTexels(const TexturePicture& picture, const CancelCheck& cancel) const {
    BadTexels bad;
    forEachTexel(picture, "looking at a light's texels", cancel, [&](const Texel& texel) {
        if (!std::isfinite(texel.r) || !std::isfinite(texel.g) || !std::isfinite(texel.b))
            ++bad.notFinite;
        else if (texel.r + texel.g + texel.b < 0.0f)
            ++bad.negative;
    });
    return bad;
}

std::array<float, 2> TextureSystem::extremes(const TexturePicture& picture,
                                             const CancelCheck& cancel) const {
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    std::array<float, 2> found{kInfinity, -kInfinity};
    const auto add = [&](float value) {
        if (!std::isfinite(value)) value = 0.0f;
        found = {std::min(found[0], value), std::max(found[1], value)};
    };
    forEachTexel(picture, "looking at a texture's heights", cancel,
                 [&](const Texel& texel) { add(texel.r); });
    const bool hasOutside = picture.wrapS == Wrap::kBlack || picture.wrapT == Wrap::kBlack;
    if (hasOutside) add(withGain(picture, {}).r);
    return found;
}

}  // namespace pm::plugin
