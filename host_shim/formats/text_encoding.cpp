// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/formats/text_encoding.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>

namespace pm::host {
namespace {

// Code points of the bytes 0x80 to 0x9f in Windows-1252; 0 where there is none.
constexpr std::array<char32_t, 32> kMarks{
    0x20ac, 0,      0x201a, 0x0192, 0x201e, 0x2026, 0x2020, 0x2021, 0x02c6, 0x2030, 0x0160,
    0x2039, 0x0152, 0,      0x017d, 0,      0,      0x2018, 0x2019, 0x201c, 0x201d, 0x2022,
    0x2013, 0x2014, 0x02dc, 0x2122, 0x0161, 0x203a, 0x0153, 0,      0x017e, 0x0178};

void append(char32_t point, std::string& text) {
    if (point < 0x80) {
        text += static_cast<char>(point);
    } else if (point < 0x800) {
        text += static_cast<char>(0xc0 | (point >> 6));
        text += static_cast<char>(0x80 | (point & 0x3f));
    } else {
        text += static_cast<char>(0xe0 | (point >> 12));
        text += static_cast<char>(0x80 | ((point >> 6) & 0x3f));
        text += static_cast<char>(0x80 | (point & 0x3f));
    }
}

// Takes a code point below 0x10000 off the front; none where there is no UTF-8 of that kind.
std::optional<char32_t> takePoint(std::string_view& text) {
    const auto byte = [&text](std::size_t i) { return static_cast<unsigned char>(text[i]); };
    const std::size_t size = byte(0) < 0x80 ? 1 : byte(0) >= 0xe0 ? 3 : 2;
    if ((byte(0) >= 0x80 && byte(0) < 0xc2) || byte(0) >= 0xf0 || text.size() < size)
        return std::nullopt;
    char32_t point = size == 1 ? byte(0) : byte(0) & (size == 2 ? 0x1f : 0x0f);
    for (std::size_t i = 1; i < size; ++i) {
        if ((byte(i) & 0xc0) != 0x80) return std::nullopt;
        point = point << 6 | (byte(i) & 0x3f);
    }
    text.remove_prefix(size);
    return point;
}

std::string utf8OfLatin(std::string_view text) {
    std::string result;
    for (const char c : text) {
        const auto byte = static_cast<unsigned char>(c);
        const char32_t mark = byte >= 0x80 && byte < 0xa0 ? kMarks[byte - 0x80] : byte;
        if (mark == 0) return {};
        append(mark, result);
    }
    return result;
}

}  // namespace

std::string inOtherEncoding(std::string_view text) {
    if (std::ranges::all_of(text, [](char c) { return static_cast<unsigned char>(c) < 0x80; }))
        return {};
    std::string latin;
    for (std::string_view rest = text; !rest.empty();) {
        const auto point = takePoint(rest);
        if (!point) return utf8OfLatin(text);
        const auto mark = std::ranges::find(kMarks, *point);
        if (*point < 0x80 || (*point >= 0xa0 && *point < 0x100))
            latin += static_cast<char>(*point);
        else if (mark != kMarks.end())
            latin += static_cast<char>(0x80 + (mark - kMarks.begin()));
        else
            return {};
    }
    return latin;
}

}  // namespace pm::host
