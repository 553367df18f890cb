// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/pictures/image_output.h"
#include "host_shim/pictures/writers/picture_format.h"

namespace pm::host {
namespace {

class Tiff : public DisplayFormat {
  public:
    std::span<const std::string_view> endings() const override {
        static constexpr std::string_view kEndings[] = {".tif", ".tiff"};
        return kEndings;
    }
    bool holds16Bits() const override { return true; }
    bool holdsAlpha() const override { return true; }
    void describe(const DisplayWriteOptions&, OIIO::ImageSpec& spec) const override {
        spec.attribute("compression", "zip");
        spec.attribute("DateTime", kFixedDateTime);
        // The writer can't put an Exif directory through a proxy, and we have none to write.
        spec.attribute("tiff:write_exif", 0);
    }
};

}  // namespace

const DisplayFormat& tiffFormat() {
    static const Tiff kFormat;
    return kFormat;
}

}  // namespace pm::host
