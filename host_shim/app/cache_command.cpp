// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/app/cache_command.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <cstdio>
#include <ctime>
#include <string>

#include "host_shim/process/interrupt.h"
#include "host_shim/render/texture_setup.h"
#include "host_shim/values/host_error.h"

namespace pm::host {
namespace {

constexpr double kMib = 1024.0 * 1024.0;

void print(const std::string& text) {
    std::fwrite(text.data(), 1, text.size(), stdout);
    std::fflush(stdout);
}

std::string listing(const TextureCache& cache, std::uint64_t limitBytes) {
    std::string text;
    std::uint64_t bytes = 0;
    const auto entries = cache.list();
    for (const TextureCache::Entry& entry : entries) {
        bytes += entry.bytes;
        text += fmt::format("{:10.1f} MiB  {:%Y-%m-%d %H:%M}  {}  {}\n",
                            static_cast<double>(entry.bytes) / kMib,
                            fmt::gmtime(static_cast<std::time_t>(entry.lastUsed)),
                            entry.file.filename().string(), entry.source);
    }
    return text + fmt::format("{}: {} textures, {:.1f} MiB of at most {:.0f} MiB\n",
                              cache.folder().string(), entries.size(),
                              static_cast<double>(bytes) / kMib,
                              static_cast<double>(limitBytes) / kMib);
}

}  // namespace

int runCacheCommand(const Options& options) {
    const std::filesystem::path folder = textureCacheFolder(options);
    if (folder.empty())
        throw HostError(ExitCode::kFile,
                        "cache: neither XDG_CACHE_HOME nor HOME says where it is; give "
                        "--texture-cache DIR");
    const std::uint64_t limit = textureCacheBytes(options);
    if (!std::filesystem::is_directory(folder)) {
        if (!options.textureCache.empty())
            throw HostError(ExitCode::kFile,
                            fmt::format("--texture-cache {}: is no folder", folder.string()));
        print(fmt::format("{}: no texture has been prepared yet\n", folder.string()));
        return 0;
    }
    TextureCache cache(folder, limit);
    int code = 0;
    if (options.cacheVerify) {
        for (const std::string& fault : cache.verify(throwIfInterrupted)) {
            print(fault + "\n");
            code = static_cast<int>(ExitCode::kBadInput);
        }
    }
    if (options.cacheClear)
        print(fmt::format("{}: {} textures removed\n", folder.string(), cache.clear()));
    if (options.cacheList) print(listing(cache, limit));
    return code;
}

}  // namespace pm::host
