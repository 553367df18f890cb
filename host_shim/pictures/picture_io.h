// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "host_shim/pictures/file_ending.h"
#include "host_shim/pictures/finished_file.h"
#include "host_shim/pictures/picture.h"
#include "host_shim/values/host_error.h"

namespace pm::host {

// A kind of picture file; writers/picture_format.h.
class PictureFormat;

// By the extension, in any case. Errors: kUsage with the extensions allowed.
const PictureFormat& pictureFormat(const std::filesystem::path& path);
// All endings with their dots, in the order of messages: ".exr" first.
std::vector<std::string_view> pictureEndings();
// The usual endings of those that go through display and view, or of those that don't, with blanks
// between them.
std::string usualEndings(bool displayReferred);
// Through display and view, or scene-linear (.exr).
bool isDisplayReferred(const PictureFormat& format);
// The same by a name of any ending; false for those of no format.
bool isDisplayPictureName(const std::filesystem::path& path);

// Before the first ray: the format is known (else kUsage) and a file can be made there and take the
// name (else kFile): the folder exists, a temporary file can be created in it, and the name is not
// that of a folder, a device or a file that may not be written.
void checkWritable(const std::filesystem::path& path);

struct ExrOptions {
    bool halfColour{};  // --exr-half: channels with isColour as half, data stays float
};
struct ExrReport {
    std::int64_t clampedToHalf{};  // finite values beyond +-65504, written as that
};

// One part, scanline, ZIP. Writes the same bytes for the same picture. The file appears under its
// name only when it is whole. NaN and infinity are written as they are: counting them is for the
// one who rendered them.
// Errors: kFile when it can't be written; kInternal when a channel does not fill the data window or
// a name occurs twice.
ExrReport writeExr(const std::filesystem::path& path, const Picture& picture,
                   const ExrOptions& options = {});

// A scene-linear picture in the format of its name. Errors: as writeExr.
ExrReport writeLinearPicture(const std::filesystem::path& path, const Picture& picture,
                             const ExrOptions& options = {});

struct DisplayWriteOptions {
    int bitDepth{8};      // 8 or 16; 16 for .png and .tif
    int jpegQuality{95};  // 1..100
    // Into the metadata, as pm:exposure in a .png and as the description in all; empty: none.
    std::string exposure{};
};

// .png, .jpg or .tif. Code = floor(value * (2^bitDepth - 1) + 0.5), values clamped to [0,1] and NaN
// as 0. Alpha is straight; .jpg has none, so there the colours are multiplied by it (over black).
// Errors: kFile when it can't be written, kUsage for a depth that the format has not.
void writeDisplayPicture(const std::filesystem::path& path, const DisplayPicture& picture,
                         const DisplayWriteOptions& options = {});

// A PNG of 8 bits a channel as the address of an <img>: data:image/png;base64,... with the codes
// that writeDisplayPicture writes. Errors: kInternal when it can't be encoded.
std::string pngDataUri(const DisplayPicture& picture);

// The first part of an EXR file with all its channels as floats, its windows and its attributes.
// Errors: kFile when it can't be opened; kBadInput when it is no EXR, broken or truncated, or its
// display window does not begin at 0,0.
Picture readExr(const std::filesystem::path& path);

}  // namespace pm::host
