// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>
#include <exception>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "host_shim/colour/colour_pipeline.h"
#include "host_shim/textures/texture_cache.h"
#include "host_shim/textures/texture_facts.h"
#include "host_shim/values/host_error.h"

namespace pm::host {

struct TextureRequest {
    std::filesystem::path file{};
    TextureKind kind{TextureKind::kColour};
    std::string colorspace{};  // -colorspace of the map line; empty when it has none
    char channel{};            // of -imfchan: r g b m l z, or 0
};

struct BakedTexture {
    std::filesystem::path file;  // to be looked up: in the cache, or the picture itself
    TextureSpace space;          // what the picture was taken to be in
    TextureFacts facts;
    std::string profile;  // an embedded ICC profile that nobody obeyed; empty: none
};

// A texture could be made, but not be kept: the disk is full, say.
class NotKept : public HostError {
  public:
    using HostError::HostError;
};

// Where textures are kept, and what making them may take.
struct TextureSettings {
    std::uint32_t threads{1};
    std::uint64_t memoryBytes{};  // that those share that are made at once
    // Told before the largest is made, also where it is in the cache; decides then, by throwing,
    // in place of memoryBytes. what: as "texture FILE of W x H texels takes".
    std::function<void(std::uint64_t bytes, const std::string& what)> takes{};
    // Asked once, where a texture can't be kept in the cache: another one for those. why: for
    // people. Empty: texture() throws NotKept.
    std::function<std::shared_ptr<TextureCache>(const std::string& why)> otherCache{};
};

// How many files were opened for it.
struct TextureCounts {
    std::uint64_t originalsOpened{};  // to be hashed, looked at or converted
    std::uint64_t converted{};
    std::uint64_t found{};  // in the cache
};

// Textures of pictures, from the cache where they are there, else made, several at once.
class TexturePreparer {
  public:
    // cache: also owned by threads that were left behind. goOn: called again and again while
    // textures are prepared; what it throws ends that soon. colour must outlive the preparer.
    TexturePreparer(const ColourPipeline& colour, std::shared_ptr<TextureCache> cache,
                    const TextureSettings& settings, std::function<void()> goOn = {});

    // Prepares all that are not there yet. What fails is thrown by texture(). Threads: one at a
    // time. Errors: HostError kMemory where one takes more memory than it may; those of otherCache.
    void prepare(const std::vector<TextureRequest>& requests);
    // One of them; prepares it now where that has not been done. Errors: HostError kFile when the
    // picture is missing, NotKept when the texture can't be; kBadInput when it is broken, no
    // picture, or its colour space is unknown; those of prepare(). The text names the file.
    const BakedTexture& texture(const TextureRequest& request);
    const TextureCounts& counts() const { return m_counts; }

  private:
    struct Work;
    struct Shared;
    void decideSpaces(std::vector<Work>& works) const;
    std::uint64_t memoryFor(const std::vector<Work>& works) const;
    void each(const std::shared_ptr<Shared>& shared,
              const std::function<void(Shared&, Work&, const std::function<void()>&)>& step);
    void makeTextures(const std::shared_ptr<Shared>& shared);

    const ColourPipeline& m_colour;
    std::shared_ptr<TextureCache> m_cache, m_fullCache;
    TextureSettings m_settings;
    std::function<void()> m_goOn;
    struct Result {
        BakedTexture texture;
        std::exception_ptr error;
    };
    std::map<std::string, Result> m_results;
    TextureCounts m_counts;
};

}  // namespace pm::host
