// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <filesystem>
#include <string>

namespace pm::host {

// OpenImageIO's name of the reader for a picture file, told by its first bytes ("png", "openexr"),
// whatever its name says; empty where it is no picture. Without this a file that is none goes
// through every reader there is, some of which read it whole. Reads a few bytes; Targa, which has
// no mark at its beginning, is known by its footer or by a name in .tga beside a likely header.
// Errors: HostError kFile when the file is missing, no regular file or can't be read.
std::string pictureReader(const std::filesystem::path& file);

// Whether a picture of colours has an alpha; false for what can't be read as one. Reads the header.
bool hasAlpha(const std::filesystem::path& file);

}  // namespace pm::host
