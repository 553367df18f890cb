// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/textures/png_colour.h"

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <string_view>

namespace pm::host {
namespace {

constexpr double kUnit = 100000;  // of gAMA and cHRM

std::uint32_t numberAt(std::string_view bytes, std::size_t at) {
    std::uint32_t number = 0;
    for (std::size_t i = at; i < at + 4; ++i)
        number = number << 8 | static_cast<unsigned char>(bytes[i]);
    return number;
}

void take(std::string_view name, std::string_view bytes, PngColour& colour) {
    constexpr std::size_t kFigures = 8;
    if (name == "iCCP") {
        colour.profileName = bytes.substr(0, bytes.find('\0'));
    } else if (name == "sRGB") {
        colour.isSrgb = true;
    } else if (name == "gAMA" && bytes.size() == 4) {
        colour.gamma = numberAt(bytes, 0) / kUnit;
    } else if (name == "cHRM" && bytes.size() == 4 * kFigures) {
        // White comes first in the file.
        auto& figures = colour.chromaticities.emplace();
        for (std::size_t i = 0; i < kFigures; ++i)
            figures[(i + 6) % kFigures] = static_cast<float>(numberAt(bytes, 4 * i) / kUnit);
    }
}

}  // namespace

PngColour readPngColour(const std::filesystem::path& file) {
    constexpr int kMark = 8, kMostChunks = 10000;
    constexpr std::uint32_t kMostRead = 80;  // the longest name of a profile, or the figures
    PngColour colour;
    std::ifstream stream(file, std::ios::binary);
    stream.ignore(kMark);
    std::array<char, 8> head{};
    for (int i = 0; i < kMostChunks && stream.read(head.data(), head.size()); ++i) {
        const std::string_view bytes(head.data(), head.size());
        const std::uint32_t length = numberAt(bytes, 0);
        const std::string_view name = bytes.substr(4);
        if (name == "IDAT" || length > 0x7fffffffu) break;
        std::array<char, kMostRead> data{};
        const std::uint32_t size = std::min(length, kMostRead);
        if (!stream.read(data.data(), size)) break;
        take(name, {data.data(), size}, colour);
        stream.seekg(std::streamoff{length - size} + 4, std::ios::cur);  // and the checksum
    }
    return colour;
}

}  // namespace pm::host
