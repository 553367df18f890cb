// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/pictures/writers/picture_format.h"

namespace pm::host {
namespace {

class Png : public DisplayFormat {
  public:
    std::span<const std::string_view> endings() const override {
        static constexpr std::string_view kEndings[] = {".png"};
        return kEndings;
    }
    bool holds16Bits() const override { return true; }
    bool holdsAlpha() const override { return true; }
    void describe(const DisplayWriteOptions& options, OIIO::ImageSpec& spec) const override {
        // Of names of our own only PNG has room.
        if (!options.exposure.empty()) spec.attribute("pm:exposure", options.exposure);
        // Three times as fast as what the library takes, for files of a twentieth more.
        spec.attribute("png:compressionLevel", 4);
    }
};

}  // namespace

const DisplayFormat& pngFormat() {
    static const Png kFormat;
    return kFormat;
}

}  // namespace pm::host
