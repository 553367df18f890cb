// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <OpenImageIO/oiioversion.h>

#include <array>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>

#include "integrator/materials/texture_source.h"
#include "integrator/values/cancel_check.h"
#include "integrator/values/uv_footprint.h"
#include "integrator/values/vec.h"

OIIO_NAMESPACE_BEGIN
class ImageCache;
class TextureSystem;
OIIO_NAMESPACE_END

namespace pm::plugin {

// What lies outside [0,1]; the numbers are those of PMR_WRAP_* in pm_plugin.h.
enum class Wrap : std::int32_t { kRepeat, kClamp, kMirror, kBlack };

// A texture as a host asks for it: value = base + gain * texel. All numbers finite.
struct TextureDescription {
    std::string fileName;
    Wrap wrapS = Wrap::kRepeat, wrapT = Wrap::kRepeat;
    Vec2f uvScale{1.0f, 1.0f};
    Vec2f uvOffset{};
    float gain = 1.0f;
    float base = 0.0f;
    std::array<std::uint64_t, 2> texelHash{};  // that the host knows; 0, 0: none
};

// A picture and how it is looked up; a plain value that many scenes may share.
struct TexturePicture {
    std::string fileName;
    void* handle = nullptr;  // OIIO::TextureSystem::TextureHandle, whose header is dear to compile
    std::uint32_t width = 1, height = 1;  // texels of the finest level
    int channelCount = 1;                 // as the file has, at most 4 are used
    float largestCode = 1.0f;             // of the file's integers of 8 or 16 bits; else 1
    Wrap wrapS = Wrap::kRepeat, wrapT = Wrap::kRepeat;
    Vec2f uvScale{1.0f, 1.0f};
    Vec2f uvOffset{};
    float gain = 1.0f;
    float base = 0.0f;
    std::array<std::uint64_t, 2> texelHash{};  // that the host knows; 0, 0: none
};

// Checksum (XXH3, 128 bits) of a picture's size, channels and finest level, texel by texel: the
// same picture in another file or of another date has the same. Throws CallError(IO);
// Error(kCancelled) soon after cancel is set.
std::array<std::uint64_t, 2> texelHash(const std::string& fileName, const CancelCheck& cancel);

// What was read of pictures so far, through the cache, by all renders of the same context. Once:
// not counting again what was read again, as the cache had let go of it.
struct TextureReads {
    std::uint64_t tiles = 0, bytes = 0;  // the cache's misses
    std::uint64_t tilesOnce = 0, bytesOnce = 0, texelsOnce = 0;

    TextureReads& operator+=(const TextureReads& other);
};

// A texture cache of our own: neither its contents nor its options mix with another user of the
// same library in this process. Options that change values are all set here, so that what the
// library takes from the environment has no say.
// Threads: any, at once.
class TextureSystem {
  public:
    TextureSystem() = default;
    ~TextureSystem();
    TextureSystem(const TextureSystem&) = delete;
    TextureSystem& operator=(const TextureSystem&) = delete;

    // Opens the picture. Throws CallError(IO) for a file that is not there or can't be read.
    TexturePicture open(const TextureDescription& description);

    // Texels that are held at once, in bytes; those of the render that asked last, as all renders
    // of a context share them. At least kLeastBytes. The look-ups are the same.
    static constexpr std::uint64_t kLeastBytes = std::uint64_t{16} << 20;
    void holdAtMost(std::uint64_t bytes);

    // The picture's value at uv, origin bottom left. Bilinear within a level, linear between the
    // levels of a mip-mapped file, by several probes along a footprint's longer side; a file
    // without levels is looked up at its only one whatever the footprint. One channel is grey, two
    // are grey and alpha; gain and base apply to the colour. Returns false, and a texel of 0, when
    // the look-up failed or gave no finite number.
    bool lookUp(const TexturePicture& picture, Vec2f uv, const UvFootprint& footprint,
                Texel& texel) const;

    // The same of a light, at the finest level: each texel without what is no light in it, then
    // interpolated. See TextureSource.
    bool lookUpOfLight(const TexturePicture& picture, Vec2f uv, Texel& texel) const;
    // Looks at all texels of the finest level. Throws CallError(IO); Error(kCancelled) soon after
    // cancel is set.
    BadTexels badTexels(const TexturePicture& picture, const CancelCheck& cancel) const;

    // The least and the largest first channel of all texels of the finest level, gain and base
    // applied, and of what is outside. Texels that are no finite number count as 0, as their
    // look-up does. Errors as above.
    std::array<float, 2> extremes(const TexturePicture& picture, const CancelCheck& cancel) const;

    TextureReads reads(const TexturePicture& picture) const;

  private:
    OIIO::TextureSystem& system();
    // Calls visit(texel) for all of the finest level, in rows. while: for "cancelled while".
    template <typename Visit>
    void forEachTexel(const TexturePicture& picture, const char* what, const CancelCheck& cancel,
                      const Visit& visit) const;

    std::once_flag m_once;
    OIIO::ImageCache* m_cache = nullptr;  // of m_system alone
    OIIO::TextureSystem* m_system = nullptr;
};

}  // namespace pm::plugin
