// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <memory>

#include "host_shim/cli/options.h"
#include "host_shim/log/log.h"
#include "host_shim/process/temporary_folder.h"
#include "host_shim/render/scene_memory.h"
#include "host_shim/textures/texture_preparation.h"

namespace pm::host {

// What the command line says of the folder of prepared textures.
std::filesystem::path textureCacheFolder(const Options& options);
std::uint64_t textureCacheBytes(const Options& options);

// The cache that the command line asks for, else the user's own; where that can't be written one in
// the temporary folder, which is told. Errors: HostError kFile where there is no such folder
// either.
std::shared_ptr<TextureCache> openTextureCache(const Options& options, TemporaryFolder& temporary,
                                               Log& log);

// One in the temporary folder, for this run; why: the other can't be used, which is told. Errors:
// HostError kFile.
std::shared_ptr<TextureCache> openRunsCache(const Options& options, const std::string& why,
                                            TemporaryFolder& temporary, Log& log);

// Threads and memory for preparing textures.
// memory: of the render to come, told what is taken; must outlive them.
TextureSettings textureSettings(const Options& options, HostMemory& memory);

}  // namespace pm::host
