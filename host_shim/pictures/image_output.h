// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <OpenImageIO/imageio.h>

#include <filesystem>
#include <functional>
#include <memory>

#include "host_shim/pictures/checked_file.h"
#include "host_shim/pictures/finished_file.h"

namespace pm::host {

// Given to every file: OpenImageIO would put in the time of day, and two runs must give the same
// bytes.
inline constexpr const char* kFixedDateTime = "2000:01:01 00:00:00";

// Writes one picture through OpenImageIO under a temporary name and commits it when nothing failed
// on the way. write is given the open output and returns what OpenImageIO returned.
// Errors: HostError kFile, naming the final path.
void writeImage(const std::filesystem::path& path, const OIIO::ImageSpec& spec,
                const std::function<bool(OIIO::ImageOutput&)>& write);

}  // namespace pm::host
