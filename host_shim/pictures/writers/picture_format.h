// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <OpenImageIO/imageio.h>

#include <span>
#include <string_view>

#include "host_shim/pictures/picture_io.h"

namespace pm::host {

// What a kind of picture file has to say of itself. A new one has a file of its own in this folder
// and its name in picture_formats.cpp.
class PictureFormat {
  public:
    virtual ~PictureFormat() = default;

    // The ends of names that mean it, with their dots, in small letters; the usual one first.
    virtual std::span<const std::string_view> endings() const = 0;
    // Through display and view; else scene-linear with all channels.
    virtual bool isDisplayReferred() const = 0;
};

// One that holds scene-linear values.
class LinearFormat : public PictureFormat {
  public:
    bool isDisplayReferred() const final { return false; }
    // As writeLinearPicture.
    virtual ExrReport write(const std::filesystem::path& path, const Picture& picture,
                            const ExrOptions& options) const = 0;
};

// One that holds codes. All are written alike but for this.
class DisplayFormat : public PictureFormat {
  public:
    bool isDisplayReferred() const final { return true; }
    virtual bool holds16Bits() const = 0;
    virtual bool holdsAlpha() const = 0;
    // Adds to spec what the kind has beside size and codes.
    virtual void describe(const DisplayWriteOptions& options, OIIO::ImageSpec& spec) const = 0;
};

const LinearFormat& exrFormat();
const DisplayFormat& pngFormat();
const DisplayFormat& jpegFormat();
const DisplayFormat& tiffFormat();

}  // namespace pm::host
