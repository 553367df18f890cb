// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <OpenImageIO/imageio.h>

#include <filesystem>
#include <string>

#include "host_shim/colour/picture_statement.h"
#include "host_shim/textures/picture_layout.h"

namespace pm::host {

// What an open picture says of its colours: a PNG by its own chunks (iCCP, else sRGB, else gAMA and
// cHRM), an EXR by its attributes, others by an embedded profile or a gamma. What OpenImageIO only
// guesses by the format is no statement. format: see pictureReader(); spec: of the part that layout
// chose.
PictureStatement statedColours(const std::string& format, const std::filesystem::path& file,
                               const OIIO::ImageSpec& spec, const PictureLayout& layout);

}  // namespace pm::host
