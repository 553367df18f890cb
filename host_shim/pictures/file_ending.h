// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <filesystem>
#include <string>

namespace pm::host {

// The ending of a name with its dot, letters A to Z as a to z: ".exr" of "A.EXR".
std::string lowerCaseExtension(const std::filesystem::path& path);

}  // namespace pm::host
