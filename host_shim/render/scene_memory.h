// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>

#include "host_shim/cli/options.h"
#include "host_shim/formats/scene_data.h"

namespace pm::host {

inline constexpr std::uint32_t kTessellationRate = 8;  // of cages

// What --memory-limit says; 0: nothing, and the library goes by the machine.
double memoryLimitGib(const Options& options);
std::uint64_t memoryLimitBytes(const Options& options);

// Of what a scene file says and what it makes of it, before either is there.
// Errors: HostError, exit code 5, where --memory-limit is given and is less.
void checkFileFits(const Options& options);                          // the text and what is read
void checkSceneFits(const Options& options, const SceneData& data);  // its triangles

}  // namespace pm::host
