// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/process/plain_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <iterator>

namespace pm::host {
namespace {

constexpr char32_t kNone = 0xffffffff;

struct Character {
    char32_t code{kNone};  // kNone where the bytes are no UTF-8
    std::size_t bytes{1};
};

// The first of text, which is not empty; as RFC 3629 has it: nothing longer than needed, no
// surrogates, nothing beyond U+10FFFF.
Character firstOf(std::string_view text) {
    const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
    const unsigned lead = byte(0);
    if (lead < 0x80) return {lead, 1};
    const std::size_t bytes = lead < 0xc2 ? 0 : lead < 0xe0 ? 2 : lead < 0xf0 ? 3 : 4;
    if (bytes == 0 || lead > 0xf4 || bytes > text.size()) return {};
    char32_t code = lead & (0xffu >> (bytes + 1));
    for (std::size_t i = 1; i < bytes; ++i) {
        if ((byte(i) & 0xc0u) != 0x80) return {};
        code = code << 6 | (byte(i) & 0x3fu);
    }
    constexpr std::array<char32_t, 5> kLeast{0, 0, 0x80, 0x800, 0x10000};
    if (code < kLeast[bytes] || code > 0x10ffff || (code >= 0xd800 && code < 0xe000)) return {};
    return {code, bytes};
}

bool isObeyed(char32_t code) {
    const auto within = [code](char32_t first, char32_t last) {
        return code >= first && code <= last;
    };
    return code < 0x20 || within(0x7f, 0x9f) || code == 0x61c || within(0x200e, 0x200f) ||
           within(0x2028, 0x202e) || within(0x2066, 0x2069) || within(0xfffe, 0xffff);
}

// other: what "\n" and "\t" become; 0 where they stay.
template <typename Escape>
std::string made(std::string_view text, char other, const Escape& escape) {
    std::string plain;
    plain.reserve(text.size());
    while (!text.empty()) {
        const Character character = firstOf(text);
        const std::string_view bytes = text.substr(0, character.bytes);
        text.remove_prefix(character.bytes);
        if (character.code == '\n' || character.code == '\t') {
            plain += other != 0 ? other : bytes[0];
        } else if (character.code == kNone || isObeyed(character.code)) {
            escape(plain, character.code == kNone ? char32_t{static_cast<unsigned char>(bytes[0])}
                                                  : character.code);
        } else {
            plain += bytes;
        }
    }
    return plain;
}

void escapeForPeople(std::string& plain, char32_t code) {
    const auto number = static_cast<std::uint32_t>(code);
    if (number < 0x100)
        fmt::format_to(std::back_inserter(plain), "\\x{:02x}", number);
    else
        fmt::format_to(std::back_inserter(plain), "\\u{:04x}", number);
}

}  // namespace

std::string plainText(std::string_view text) {
    return made(text, ' ', escapeForPeople);
}

std::string plainLines(std::string_view text) {
    return made(text, '\0', escapeForPeople);
}

std::string plainJson(std::string_view document) {
    return made(document, '\0', [](std::string& plain, char32_t code) {
        fmt::format_to(std::back_inserter(plain), "\\u{:04x}", static_cast<std::uint32_t>(code));
    });
}

std::string withoutPasswords(std::string_view text) {
    constexpr std::string_view kBegins = "://";
    std::string shown;
    for (std::size_t begin = text.find(kBegins); begin != text.npos; begin = text.find(kBegins)) {
        begin += kBegins.size();
        shown += text.substr(0, begin);
        text.remove_prefix(begin);
        const std::string_view server = text.substr(0, text.find_first_of("/?# \t\n'\""));
        const std::size_t at = server.rfind('@');
        if (at != server.npos) text.remove_prefix(at + 1);
    }
    return shown.append(text);
}

}  // namespace pm::host
