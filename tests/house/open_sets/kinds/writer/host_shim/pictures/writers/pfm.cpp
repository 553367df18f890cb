// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include <fmt/format.h>

#include <string>

#include "host_shim/pictures/finished_file.h"
#include "host_shim/pictures/writers/picture_format.h"

namespace pm::host {
namespace {

// Floats, bottom line first.
class Pfm : public LinearFormat {
  public:
    std::span<const std::string_view> endings() const override {
        static constexpr std::string_view kEndings[] = {".pfm"};
        return kEndings;
    }
    ExrReport write(const std::filesystem::path& path, const Picture& picture,
                    const ExrOptions&) const override {
        const PixelRect& window = picture.dataWindow;
        std::string bytes = fmt::format("PF\n{} {}\n-1.0\n", window.width(), window.height());
        for (std::int32_t y = window.height(); y-- > 0;)
            for (std::int32_t x = 0; x < window.width(); ++x)
                for (const char* name : {"R", "G", "B"}) {
                    const std::size_t i = static_cast<std::size_t>(y * window.width() + x);
                    const float value = picture.find(name)->values[i];
                    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
                }
        writeFinishedFile(path, bytes);
        return {};
    }
};

}  // namespace

const LinearFormat& pfmFormat() {
    static const Pfm kFormat;
    return kFormat;
}

}  // namespace pm::host
