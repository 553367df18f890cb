// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <OpenImageIO/oiioversion.h>

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "integrator/materials/texture_source.h"
#include "integrator/values/cancel_check.h"
#include "integrator/values/uv_footprint.h"
#include "integrator/values/vec.h"
#include "plugin/textures/texture_picture.h"

OIIO_NAMESPACE_BEGIN
class ImageCache;
class TextureSystem;
OIIO_NAMESPACE_END

namespace pm::plugin {

class TilesOfThreads;

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
    TextureSystem();
    ~TextureSystem();
    TextureSystem(const TextureSystem&) = delete;
    TextureSystem& operator=(const TextureSystem&) = delete;

    // Opens the picture. Throws CallError(IO) for a file that is not there or can't be read.
    TexturePicture open(const TextureDescription& description);

    // Texels that are held at once, in bytes; those of the render that asked last, as all renders
    // of a context share them. At least kLeastBytes. all: of all texels there are, where threads
    // may hold whatever they looked at; 0: not known. The look-ups are the same.
    static constexpr std::uint64_t kLeastBytes = std::uint64_t{16} << 20;
    void holdAtMost(std::uint64_t bytes, std::uint64_t all = 0);

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
    // Whether a picture's colour is known by its coarser levels, each the mean of the one before,
    // to be 0 all over a box of uv; no where it has no levels.
    bool isBlackWithin(const TexturePicture& picture, Vec2f lo, Vec2f hi) const;
    // Looks at all texels of the finest level, in parallel in the calling TBB arena. Throws
    // CallError(IO); Error(kCancelled) soon after cancel is set.
    BadTexels badTexels(const TexturePicture& picture, const CancelCheck& cancel) const;

    // The least and the largest first channel of all texels of the finest level, gain and base
    // applied, and of what is outside; in parallel likewise. Texels that are no finite number count
    // as 0, as their look-up does. Errors as above.
    std::array<float, 2> extremes(const TexturePicture& picture, const CancelCheck& cancel) const;

    TextureReads reads(const TexturePicture& picture) const;

  private:
    OIIO::TextureSystem& system();
    TextureFile fileOf(const TexturePicture& picture);
    // Calls visit(found, texel) for all of the finest level, a Found for each strip of rows, in
    // parallel. what: for "cancelled while".
    template <typename Found, typename Visit>
    std::vector<Found> lookAtTexels(const TexturePicture& picture, const char* what,
                                    const CancelCheck& cancel, const Visit& visit) const;

    std::once_flag m_once;
    OIIO::ImageCache* m_cache = nullptr;  // of m_system alone
    OIIO::TextureSystem* m_system = nullptr;
    std::unique_ptr<TilesOfThreads> m_tiles;
    std::atomic<std::uint64_t> m_files{0};  // numbers given so far
};

}  // namespace pm::plugin
