// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>
#include <string_view>

#include "host_shim/values/go_on.h"

namespace pm::host {

// wanted: what messages call the right file, "an OBJ file". Errors: kFile when the file can't be
// opened for reading, kBadInput when it is a folder.
void checkSceneFile(const std::filesystem::path& file, std::string_view wanted);

// A file as a whole, of at most so many bytes. goOn is called for each MiB. Errors: kFile, with the
// system's reason, also for what is no file but a pipe, a device or a folder; kBadInput for one
// that has more.
std::string readWholeFile(const std::filesystem::path& file, const GoOn& goOn = {},
                          std::uint64_t mostBytes = std::numeric_limits<std::uint64_t>::max());

}  // namespace pm::host
