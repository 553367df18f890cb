// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "plugin/textures/texture_system.h"

#include <OpenImageIO/imagecache.h>
#include <OpenImageIO/imageio.h>
#include <OpenImageIO/texture.h>
#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <xxhash.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <limits>
#include <new>
#include <vector>

#include "plugin/textures/picture_file.h"
#include "plugin/textures/texture_filter.h"
#include "plugin/textures/tiles_of_threads.h"
#include "plugin/textures/watched_input.h"
#include "plugin/values/call_error.h"

namespace pm::plugin {

namespace {

// Before a render says: enough to look at all texels once, row after row.
constexpr float kFirstMegabytes = 16.0f;
// Pictures that are not tiled are cut into tiles of this size when they are read.
constexpr int kTilePixels = 64;
// Of what may be held, the share that threads hold beside the cache.
constexpr std::uint64_t kHeldShare = 8;

OIIO::TextureSystem::TextureHandle* handleOf(const TexturePicture& picture) {
    return static_cast<OIIO::TextureSystem::TextureHandle*>(picture.handle);
}

[[noreturn]] void throwUnreadable(const std::string& fileName, const std::string& why) {
    throw CallError(CallStatus::kIo, fmt::format("texture {} can't be read: {}", fileName, why));
}

Texel toTexel(const TexelValues& values, int channelCount) {
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

TextureSystem::TextureSystem() = default;

TextureSystem::~TextureSystem() {
    m_tiles.reset();
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
        m_tiles = std::make_unique<TilesOfThreads>(*m_cache);
        m_tiles->holdAtMost(kLeastBytes / kHeldShare);
        m_system = made;
    });
    return *m_system;
}

void TextureSystem::holdAtMost(std::uint64_t bytes, std::uint64_t all) {
    if (bytes == 0) return;
    const std::uint64_t held = std::max(bytes, kLeastBytes);
    const bool isAll = all > 0 && all <= held;
    const std::uint64_t byThreads = held / kHeldShare;
    system().attribute("max_memory_MB",
                       static_cast<float>(isAll ? held : held - byThreads) / (1024.0f * 1024.0f));
    m_tiles->holdAtMost(isAll ? std::numeric_limits<std::size_t>::max() : byThreads);
}

TexturePicture TextureSystem::open(const TextureDescription& description) {
    TexturePicture picture;
    static_cast<TextureMapping&>(picture) = description;
    picture.fileName = description.fileName;

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
    picture.file = std::make_shared<const TextureFile>(fileOf(picture));
    return picture;
}

TextureFile TextureSystem::fileOf(const TexturePicture& picture) {
    const OIIO::ustring name(picture.fileName);
    TextureFile file;
    file.number = ++m_files;
    file.handle = m_cache->get_image_handle(name);
    file.channels = std::min(picture.channelCount, 4);
    int levels = 1;
    m_cache->get_image_info(name, 0, 0, OIIO::ustring("miplevels"), OIIO::TypeInt, &levels);
    const auto bitsOf = [](int side) {
        return std::has_single_bit(static_cast<unsigned>(side))
                   ? std::countr_zero(static_cast<unsigned>(side))
                   : -1;
    };
    for (int level = 0; level < std::max(1, levels); ++level) {
        OIIO::ImageSpec spec;
        if (!m_cache->get_imagespec(name, spec, 0, level))
            throwUnreadable(picture.fileName, m_cache->geterror());
        TextureLevel of{.width = std::max(1, spec.full_width),
                        .height = std::max(1, spec.full_height),
                        .dataX = spec.x - spec.full_x,
                        .dataY = spec.y - spec.full_y,
                        .dataWidth = spec.width,
                        .dataHeight = spec.height,
                        .fileX = spec.x,
                        .fileY = spec.y,
                        .tileWidth = std::max(1, spec.tile_width),
                        .tileHeight = std::max(1, spec.tile_height)};
        of.tileBitsX = bitsOf(of.tileWidth);
        of.tileBitsY = bitsOf(of.tileHeight);
        file.levels.push_back(of);
    }
    return file;
}

bool TextureSystem::lookUp(const TexturePicture& picture, Vec2f uv, const UvFootprint& footprint,
                           Texel& texel) const {
    texel = {0.0f, 0.0f, 0.0f, 0.0f};
    const Vec2f place = placeIn(picture, uv);
    if (!std::isfinite(place.x) || !std::isfinite(place.y)) return false;
    TexelValues values;
    if (!filtered(picture, m_tiles->mine(), place, sideIn(picture, footprint.x),
                  sideIn(picture, footprint.y), values))
        return false;
    const Texel found = withGain(picture, toTexel(values, picture.channelCount));
    if (!isFinite(found)) return false;
    texel = found;
    return true;
}

bool TextureSystem::lookUpOfLight(const TexturePicture& picture, Vec2f uv, Texel& texel) const {
    texel = {0.0f, 0.0f, 0.0f, 0.0f};
    const Vec2f place = placeIn(picture, uv);
    if (!std::isfinite(place.x) || !std::isfinite(place.y)) return false;
    TexelQuad quad;
    if (!texelsAround(picture, m_tiles->mine(), place, quad)) return false;
    for (std::size_t i = 0; i < 4; ++i) {
        const float weight = ((i & 1) != 0 ? quad.right : 1.0f - quad.right) *
                             ((i & 2) != 0 ? quad.lower : 1.0f - quad.lower);
        const Texel light =
            asLight(withGain(picture, toTexel(quad.texels[i], picture.channelCount)));
        texel.r += weight * light.r;
        texel.g += weight * light.g;
        texel.b += weight * light.b;
        texel.a += weight * light.a;
    }
    return true;
}

bool TextureSystem::isBlackWithin(const TexturePicture& picture, Vec2f lo, Vec2f hi) const {
    if (picture.file->levels.size() == 1 || picture.base != 0.0f) return false;
    // Looked up at levels whose texels are no smaller than the box, the two nearest along each axis
    // cover it; a footprint of twice the size is looked up between such levels.
    const float w = static_cast<float>(picture.width) * std::abs(picture.uvScale.x),
                h = static_cast<float>(picture.height) * std::abs(picture.uvScale.y);
    const float texels = std::max({(hi.x - lo.x) * w, (hi.y - lo.y) * h, 1.0f});
    if (2.0f * texels >
        std::min(static_cast<float>(picture.width), static_cast<float>(picture.height)))
        return false;
    const UvFootprint footprint{{2.0f * texels / w, 0.0f}, {0.0f, 2.0f * texels / h}};
    Texel texel;
    return lookUp(picture, (lo + hi) * 0.5f, footprint, texel) && texel.r == 0.0f &&
           texel.g == 0.0f && texel.b == 0.0f;
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

template <typename Found, typename Visit>
std::vector<Found> TextureSystem::lookAtTexels(const TexturePicture& picture, const char* what,
                                               const CancelCheck& cancel,
                                               const Visit& visit) const {
    constexpr std::uint32_t kRows = kTilePixels;
    const int channelCount = std::min(picture.channelCount, 4);
    const auto channels = static_cast<std::size_t>(channelCount);
    std::vector<Found> found((picture.height + kRows - 1) / kRows);
    tbb::parallel_for(std::size_t{0}, found.size(), [&](std::size_t strip) {
        cancel.throwIfSet(what);
        const auto row = static_cast<std::uint32_t>(strip) * kRows;
        const std::uint32_t rows = std::min(kRows, picture.height - row);
        std::vector<float> texels(std::size_t{picture.width} * rows * channels);
        OIIO::TextureOpt options;
        if (!m_system->get_texels(handleOf(picture), m_system->get_perthread_info(), options, 0, 0,
                                  static_cast<int>(picture.width), static_cast<int>(row),
                                  static_cast<int>(row + rows), 0, 1, 0, channelCount,
                                  OIIO::TypeDesc::FLOAT, texels.data()))
            throwUnreadable(picture.fileName, m_system->geterror());
        const std::size_t count = std::size_t{picture.width} * rows;
        for (std::size_t i = 0; i < count; ++i) {
            TexelValues values{};
            std::copy_n(&texels[i * channels], channels, values.begin());
            visit(found[strip], withGain(picture, toTexel(values, channelCount)));
        }
    });
    return found;
}

BadTexels TextureSystem::badTexels(const TexturePicture& picture, const CancelCheck& cancel) const {
    const auto count = [](BadTexels& bad, const Texel& texel) {
        if (!std::isfinite(texel.r) || !std::isfinite(texel.g) || !std::isfinite(texel.b))
            ++bad.notFinite;
        else if (texel.r + texel.g + texel.b < 0.0f)
            ++bad.negative;
    };
    BadTexels all;
    for (const BadTexels& bad :
         lookAtTexels<BadTexels>(picture, "looking at a light's texels", cancel, count)) {
        all.notFinite += bad.notFinite;
        all.negative += bad.negative;
    }
    return all;
}

std::array<float, 2> TextureSystem::extremes(const TexturePicture& picture,
                                             const CancelCheck& cancel) const {
    struct Range {
        float lo = std::numeric_limits<float>::infinity(), hi = -lo;

        void add(float value) {
            if (!std::isfinite(value)) value = 0.0f;
            lo = std::min(lo, value);
            hi = std::max(hi, value);
        }
    };
    const auto add = [](Range& range, const Texel& texel) { range.add(texel.r); };
    Range all;
    for (const Range& range :
         lookAtTexels<Range>(picture, "looking at a texture's heights", cancel, add)) {
        all.add(range.lo);
        all.add(range.hi);
    }
    const bool hasOutside = picture.wrapS == Wrap::kBlack || picture.wrapT == Wrap::kBlack;
    if (hasOutside) all.add(withGain(picture, {}).r);
    return {all.lo, all.hi};
}

}  // namespace pm::plugin
