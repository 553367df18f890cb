// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Strings; POV-Ray's manual, 3.3.1.9 and 3.3.2.7.2.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <ctime>

#include "host_shim/formats/pov/evaluation/parser.h"

namespace pm::host::pov {
namespace {

void appendUtf8(std::string& text, std::uint32_t code) {
    if (code < 0x80) {
        text += static_cast<char>(code);
    } else if (code < 0x800) {
        text += static_cast<char>(0xc0 | code >> 6);
        text += static_cast<char>(0x80 | (code & 0x3f));
    } else {
        text += static_cast<char>(0xe0 | (code >> 12 & 0xf));
        text += static_cast<char>(0x80 | (code >> 6 & 0x3f));
        text += static_cast<char>(0x80 | (code & 0x3f));
    }
}

int digitOf(char c) {
    if (c >= '0' && c <= '9') return c - '0';
    const char small = static_cast<char>(c | 0x20);
    return small >= 'a' && small <= 'f' ? small - 'a' + 10 : -1;
}

}  // namespace

// Of file names a backslash before no known letter stays, as names of other systems have it.
std::string Parser::unescaped(const std::string& text, bool isFileName) const {
    if (text.find('\\') == text.npos) return text;
    constexpr std::string_view kLetters = "abfnrtv0\\'\"", kMeant{"\a\b\f\n\r\t\v\0\\'\"", 11};
    std::string result;
    for (std::size_t i = 0; i < text.size(); ++i) {
        if (text[i] != '\\' || i + 1 == text.size()) {
            result += text[i];
            continue;
        }
        const char letter = text[++i];
        if (const std::size_t which = kLetters.find(letter); which != kLetters.npos) {
            result += kMeant[which];
        } else if (letter == 'u' && i + 4 < text.size()) {
            std::uint32_t code = 0;
            for (int digit = 0; digit < 4; ++digit)
                code = code * 16 + static_cast<std::uint32_t>(std::max(0, digitOf(text[++i])));
            appendUtf8(result, code);
        } else {
            if (isFileName) result += '\\';
            result += letter;
        }
    }
    return result;
}

std::string Parser::text(bool isFileName) {
    const Lexeme token = next();
    if (token.kind == TokenKind::kString)
        return unescaped(token.source->strings[token.text], isFileName);
    if (token.kind == TokenKind::kWord) {
        if (wordOf(token) == "input_file_name") return m_around.inputFileName;
        if (m_names.use(token.name) == WordUse::kTextFunction) return textFunction(wordOf(token));
    }
    if (token.kind != TokenKind::kName) expected(token, "a string");
    const Value* const value = resolved(token);
    if (value == nullptr) fail(fmt::format("'{}' is not declared", wordOf(token)));
    const auto* const string = std::get_if<std::string>(value);
    if (string == nullptr)
        fail(fmt::format("a string was expected, and '{}' is {}", wordOf(token), kindOf(*value)));
    return *string;
}

// least: shortest length, padded with blanks, or if it is below 0 with zeros.
std::string Parser::formatted(double value, int least, int digits) const {
    constexpr int kMost = 512;
    const int width = std::clamp(std::abs(least), 0, kMost);
    const int precision = digits < 0 ? 6 : std::min(digits, kMost);
    return least < 0 ? fmt::format("{:0{}.{}f}", value, width, precision)
                     : fmt::format("{:{}.{}f}", value, width, precision);
}

std::string Parser::textFunction(const std::string& called) {
    const Deeper deeper(*this);
    const std::string word = called;
    expectSymbol('(');
    std::string result;
    const auto whole = [this] {
        expectSymbol(',');
        return static_cast<int>(std::clamp(number(), -1e6, 1e6));
    };
    if (word == "concat") {
        result = text();
        while (takeSymbol(',')) result += text();
    } else if (word == "chr") {
        appendUtf8(result, static_cast<std::uint32_t>(std::clamp(number(), 0.0, 65535.0)));
    } else if (word == "str") {
        const double value = number();
        const int least = whole(), digits = whole();
        result = formatted(value, least, digits);
    } else if (word == "vstr") {
        const double wanted = std::clamp(number(), 2.0, 5.0);
        expectSymbol(',');
        const Numbers value = expression();
        expectSymbol(',');
        const std::string between = text();
        const int least = whole(), digits = whole();
        const Numbers all = value.promoted(static_cast<std::size_t>(wanted));
        for (std::size_t i = 0; i < all.size; ++i)
            result += (i == 0 ? "" : between) + formatted(all.at[i], least, digits);
    } else if (word == "substr") {
        const std::string of = text();
        const int first = whole(), length = whole();
        if (first < 1 || length < 0 || static_cast<std::size_t>(first - 1 + length) > of.size())
            fail(fmt::format("substr from {}, {} long, of a string of {}", first, length,
                             of.size()));
        result = of.substr(static_cast<std::size_t>(first - 1), static_cast<std::size_t>(length));
    } else if (word == "datetime") {
        result = datetime();
    } else {
        result = text();
        const bool isUpper = word == "strupr";
        for (char& c : result)
            if (isUpper ? c >= 'a' && c <= 'z' : c >= 'A' && c <= 'Z')
                c = static_cast<char>(c ^ 0x20);
    }
    if (result.size() > m_around.limits.charactersOfString)
        fail(
            fmt::format("a string of more than {} characters", m_around.limits.charactersOfString));
    expectSymbol(')');
    return result;
}

// Of days since 2000, in the way of strftime.
std::string Parser::datetime() {
    const double days = number();
    const std::string format = takeSymbol(',') ? text() : "%Y-%m-%d %H:%M:%SZ";
    constexpr double kMostDays = 1e6;
    const auto seconds = static_cast<std::int64_t>(std::clamp(days, -kMostDays, kMostDays) * 86400);
    constexpr std::int64_t k2000 = 946684800;
    std::array<char, 256> result{};
    const std::time_t time = seconds + k2000;
    std::tm parts{};
    gmtime_r(&time, &parts);
    return {result.data(), std::strftime(result.data(), result.size(), format.c_str(), &parts)};
}

}  // namespace pm::host::pov
