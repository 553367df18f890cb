// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace pm::host::test {

inline std::string bigEndian(std::uint32_t number, int bytes = 4) {
    std::string text;
    for (int i = bytes - 1; i >= 0; --i) text += static_cast<char>(number >> (8 * i) & 255u);
    return text;
}

// A chunk of a PNG: name and content.
using Chunk = std::pair<std::string, std::string>;

inline std::string written(const Chunk& chunk) {
    std::uint32_t crc = ~0u;
    for (const char c : chunk.first + chunk.second) {
        crc ^= static_cast<unsigned char>(c);
        for (int bit = 0; bit < 8; ++bit) crc = crc >> 1 ^ ((crc & 1u) != 0 ? 0xedb88320u : 0u);
    }
    return bigEndian(static_cast<std::uint32_t>(chunk.second.size())) + chunk.first + chunk.second +
           bigEndian(~crc);
}

// What zlib would unpack to text, which is not packed.
inline std::string zlibOf(const std::string& text) {
    std::uint32_t a = 1, b = 0;
    for (const char c : text) {
        a = (a + static_cast<unsigned char>(c)) % 65521;
        b = (b + a) % 65521;
    }
    const auto size = static_cast<std::uint32_t>(text.size());
    const std::string little = {static_cast<char>(size & 255u), static_cast<char>(size >> 8),
                                static_cast<char>(~size & 255u), static_cast<char>(~size >> 8)};
    return "\x78\x01\x01" + little + text + bigEndian(b << 16 | a);
}

inline Chunk gamma(double value) {
    return {"gAMA", bigEndian(static_cast<std::uint32_t>(std::lround(value * 1e5)))};
}

// x,y of red, green, blue, white.
inline Chunk primaries(const std::array<double, 8>& figures) {
    std::string text;
    for (std::size_t i = 0; i < 8; ++i)
        text += bigEndian(static_cast<std::uint32_t>(std::lround(figures[(i + 6) % 8] * 1e5)));
    return {"cHRM", text};
}

inline Chunk profile(const std::string& bytes, const std::string& name = "made") {
    return {"iCCP", name + std::string(2, '\0') + zlibOf(bytes)};
}

// The chunks of a PNG that lies there are replaced by these, but for its size and its pixels.
inline void setChunks(const std::filesystem::path& png, const std::vector<Chunk>& chunks) {
    std::ifstream stream(png, std::ios::binary);
    const std::string old((std::istreambuf_iterator<char>(stream)), {});
    std::string made = old.substr(0, 8);
    for (std::size_t at = 8; at + 12 <= old.size();) {
        std::size_t length = 0;
        for (std::size_t i = at; i < at + 4; ++i)
            length = length << 8 | static_cast<unsigned char>(old[i]);
        const std::string name = old.substr(at + 4, 4);
        if (name == "IHDR" || name == "IDAT" || name == "IEND") made += old.substr(at, length + 12);
        if (name == "IHDR")
            for (const Chunk& chunk : chunks) made += written(chunk);
        at += length + 12;
    }
    std::ofstream(png, std::ios::binary | std::ios::trunc) << made;
}

inline std::string fixed(double value) {
    return bigEndian(
        static_cast<std::uint32_t>(static_cast<std::int32_t>(std::lround(value * 65536))));
}

inline std::string curveOfGamma(double exponent) {
    return std::string("curv\0\0\0\0\0\0\0\1", 12) +
           bigEndian(static_cast<std::uint32_t>(std::lround(exponent * 256)), 2) +
           std::string(2, '\0');
}

// ICC's parametric curve: 0 the power alone, 3 with a straight piece.
inline std::string parametric(std::uint32_t type, const std::vector<double>& numbers) {
    std::string tag = std::string("para\0\0\0\0", 8) + bigEndian(type, 2) + std::string(2, '\0');
    for (const double number : numbers) tag += fixed(number);
    return tag;
}

// An ICC profile of tags.
inline std::string profileOf(const std::string& space,
                             const std::vector<std::pair<std::string, std::string>>& tags) {
    std::string table = bigEndian(static_cast<std::uint32_t>(tags.size())), data;
    for (const auto& [name, content] : tags) {
        table += name +
                 bigEndian(static_cast<std::uint32_t>(132 + 12 * tags.size() + data.size())) +
                 bigEndian(static_cast<std::uint32_t>(content.size()));
        data += content;
        data.resize((data.size() + 3) / 4 * 4, '\0');
    }
    const auto size = static_cast<std::uint32_t>(128 + table.size() + data.size());
    std::string head = bigEndian(size) + std::string(4, '\0') + bigEndian(0x02400000) + "mntr" +
                       space + "XYZ " + std::string(12, '\0') + "acsp" + std::string(28, '\0') +
                       fixed(0.9642) + fixed(1) + fixed(0.8249);
    head.resize(128, '\0');
    return head + table + data;
}

// Columns: XYZ of red, green and blue under D50.
inline std::string rgbProfile(const std::array<double, 9>& columns, const std::string& curve) {
    std::vector<std::pair<std::string, std::string>> tags;
    for (std::size_t c = 0; c < 3; ++c) {
        const std::string letter(1, "rgb"[c]);
        std::string column("XYZ \0\0\0\0", 8);
        for (std::size_t i = 0; i < 3; ++i) column += fixed(columns[3 * c + i]);
        tags.emplace_back(letter + "XYZ", column);
        tags.emplace_back(letter + "TRC", curve);
    }
    return profileOf("RGB ", tags);
}

// As the profiles of that name have them.
inline constexpr std::array kSrgbColumns{0.43607, 0.22249, 0.01392, 0.38515, 0.71687,
                                         0.09708, 0.14307, 0.06061, 0.71410};
inline constexpr std::array kAdobeColumns{0.60974, 0.31111, 0.01947, 0.20528, 0.62567,
                                          0.06087, 0.14919, 0.06322, 0.74457};

}  // namespace pm::host::test
