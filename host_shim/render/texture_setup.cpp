// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/render/texture_setup.h"

#include <fmt/format.h>

#include <algorithm>
#include <thread>

#include "host_shim/formats/warnings.h"
#include "host_shim/values/host_error.h"

namespace pm::host {
namespace {

// 20 GiB: some 150 colour textures of 4096 x 4096.
constexpr double kUsualCacheGib = 20.0;
constexpr double kGib = 1024.0 * 1024.0 * 1024.0;

}  // namespace

std::filesystem::path textureCacheFolder(const Options& options) {
    return options.textureCache.empty() ? usualCacheFolder() : options.textureCache;
}

std::uint64_t textureCacheBytes(const Options& options) {
    return static_cast<std::uint64_t>(options.textureCacheGib.value_or(kUsualCacheGib) * kGib);
}

std::shared_ptr<TextureCache> openRunsCache(const Options& options, const std::string& why,
                                            TemporaryFolder& temporary, Log& log) {
    const std::string text = why + "; textures are made for this run only";
    if (options.textureCache.empty())
        log.info(text);
    else
        log.warning(static_cast<int>(Warning::kTexture), text);
    return std::make_shared<TextureCache>(temporary.path(), textureCacheBytes(options));
}

std::shared_ptr<TextureCache> openTextureCache(const Options& options, TemporaryFolder& temporary,
                                               Log& log) {
    const std::filesystem::path folder = textureCacheFolder(options);
    std::string why = "no folder for caches is known";
    if (!folder.empty()) {
        try {
            auto cache = std::make_shared<TextureCache>(folder, textureCacheBytes(options));
            if (cache->isWritable()) return cache;
            why = folder.string() + ": nothing can be written there";
        } catch (const HostError& error) {
            if (!options.textureCache.empty()) throw;
            why = error.what();
        }
    }
    return openRunsCache(options, why, temporary, log);
}

TextureSettings textureSettings(const Options& options, HostMemory& memory) {
    const unsigned all = std::max(1u, std::thread::hardware_concurrency());
    return {options.threads == 0 ? all : options.threads, memory.left(),
            [&memory](std::uint64_t bytes, const std::string& what) { memory.take(bytes, what); }};
}

}  // namespace pm::host
