// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace pm::host {

// wanted: what messages call the right file, "an OBJ file". Errors: kFile when the file can't be
// opened for reading, kBadInput when it is a folder.
void checkSceneFile(const std::filesystem::path& file, std::string_view wanted);

// A file as a whole. Errors: kFile, with the system's reason.
std::string readWholeFile(const std::filesystem::path& file);

}  // namespace pm::host
