// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// What the readers of picture files share.
#pragma once

#include <OpenImageIO/imageio.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace pm::host {

// Errors: kFile where there is no such file; kBadInput where it is no picture.
std::unique_ptr<OIIO::ImageInput> openPicture(const std::filesystem::path& path,
                                              const OIIO::ImageSpec& config);

// All channels of its first part side by side, row by row. Errors: kBadInput where it is broken.
std::vector<float> readValues(const std::filesystem::path& path, OIIO::ImageInput& input);

// Throws kBadInput, "FILE: text".
[[noreturn]] void refusePicture(const std::filesystem::path& path, const std::string& text);

}  // namespace pm::host
