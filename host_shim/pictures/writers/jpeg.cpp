// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include <fmt/format.h>

#include <algorithm>

#include "host_shim/pictures/writers/picture_format.h"

namespace pm::host {
namespace {

class Jpeg : public DisplayFormat {
  public:
    std::span<const std::string_view> endings() const override {
        static constexpr std::string_view kEndings[] = {".jpg", ".jpeg"};
        return kEndings;
    }
    bool holds16Bits() const override { return false; }
    bool holdsAlpha() const override { return false; }
    void describe(const DisplayWriteOptions& options, OIIO::ImageSpec& spec) const override {
        spec.attribute("compression",
                       fmt::format("jpeg:{}", std::clamp(options.jpegQuality, 1, 100)));
    }
};

}  // namespace

const DisplayFormat& jpegFormat() {
    static const Jpeg kFormat;
    return kFormat;
}

}  // namespace pm::host
