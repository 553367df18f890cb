// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <OpenImageIO/imageio.h>

#include <cstdint>
#include <filesystem>
#include <string>

namespace pm::host {

// Bytes that OpenImageIO's reader of a picture holds of all of it at once, beside the rows that are
// asked for; 0 where it reads row by row. format: see pictureReader. spec: of the part that is
// read. Of a JPEG or PNG its own header says whether it has to be read whole, as progressive and
// interlaced ones have. No errors: a header that can't be read is told by who reads the picture.
std::uint64_t bytesHeldWhole(const std::string& format, const std::filesystem::path& file,
                             const OIIO::ImageSpec& spec);

}  // namespace pm::host
