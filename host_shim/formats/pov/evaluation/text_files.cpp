// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// #fopen, #read, #write and #fclose; POV-Ray's manual, 3.3.2.3.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "host_shim/formats/pov/evaluation/parser.h"

namespace pm::host::pov {
namespace {

struct BinaryWord {
    std::string_view name;
    int bytes;
    bool isSigned, isBigEndian;
};
constexpr std::array<BinaryWord, 8> kBinaryWords{{
    {"uint8", 1, false, false},
    {"sint8", 1, true, false},
    {"uint16be", 2, false, true},
    {"uint16le", 2, false, false},
    {"sint16be", 2, true, true},
    {"sint16le", 2, true, false},
    {"sint32be", 4, true, true},
    {"sint32le", 4, true, false},
}};

std::string binary(double value, const BinaryWord& word) {
    const double range = std::ldexp(1.0, word.bytes * 8);
    const double low = word.isSigned ? -range / 2 : 0, high = low + range - 1;
    const auto bits = static_cast<std::uint64_t>(
        static_cast<std::int64_t>(std::clamp(std::round(value), low, high)));
    std::string bytes;
    for (int i = 0; i < word.bytes; ++i) bytes += static_cast<char>(bits >> (8 * i) & 0xff);
    if (word.isBigEndian) std::ranges::reverse(bytes);
    return bytes;
}

std::string asWritten(const Numbers& value) {
    if (value.isFloat()) return fmt::format("{:g}", value.at[0]);
    std::string text = "<";
    for (std::size_t i = 0; i < value.size; ++i)
        text += fmt::format("{}{:g}", i == 0 ? "" : ", ", value.at[i]);
    return text + ">";
}

// The next value of a file: a float with its sign, a string or a vector of floats.
std::optional<Value> valueIn(TextFile& file) {
    const auto& tokens = file.source().tokens;
    const auto isSymbol = [&](char symbol) {
        return tokens[file.at].kind == TokenKind::kSymbol && tokens[file.at].symbol == symbol;
    };
    const auto number = [&]() -> std::optional<double> {
        double sign = 1;
        for (; isSymbol('-') || isSymbol('+'); ++file.at)
            if (isSymbol('-')) sign = -sign;
        if (tokens[file.at].kind != TokenKind::kNumber) return std::nullopt;
        return sign * tokens[file.at++].number;
    };
    if (isSymbol(',')) ++file.at;
    const Token& token = tokens[file.at];
    if (token.kind == TokenKind::kString) {
        ++file.at;
        return file.source().strings[token.text];
    }
    if (!isSymbol('<')) {
        const auto value = number();
        return value ? std::optional<Value>(Numbers::of(*value)) : std::nullopt;
    }
    ++file.at;
    Numbers vector;
    vector.size = 0;
    while (!isSymbol('>')) {
        const auto value = number();
        if (!value || vector.size == 5) return std::nullopt;
        vector.at[vector.size++] = *value;
        if (isSymbol(',')) ++file.at;
    }
    ++file.at;
    return vector;
}

}  // namespace

void Parser::openFile() {
    const Lexeme name = raw();
    if (name.kind != TokenKind::kName) expected(name, "an identifier");
    const std::string file = text(true);
    const Lexeme how = raw();
    if (isWord(how, "read")) {
        // What the scene itself has written, if only to nowhere.
        if (const auto written = m_written.find(file); written != m_written.end())
            return m_symbols.declare(
                name.name, std::make_shared<TextFile>(cutIntoTokens(*written->second, file, m_names,
                                                                    m_around.limits.tokensOfFile)));
        const auto found = m_around.find(file);
        if (!found) fail(fmt::format("'{}' is not found", file));
        auto source =
            cutIntoTokens(m_around.read(*found), *found, m_names, m_around.limits.tokensOfFile);
        return m_symbols.declare(name.name, std::make_shared<TextFile>(std::move(source)));
    }
    if (!isWord(how, "write") && !isWord(how, "append")) expected(how, "read, write or append");
    std::ofstream stream;
    if (const auto path = m_around.writable(file)) {
        stream.open(*path, isWord(how, "append") ? std::ios::app | std::ios::binary
                                                 : std::ios::trunc | std::ios::binary);
        if (!stream) fail(fmt::format("'{}' can't be written", file));
    } else {
        warn(fmt::format("'{}' is not written (--allow-write lets scenes write)", file));
    }
    auto& text = m_written[file];
    if (!text || isWord(how, "write")) text = std::make_shared<std::string>();
    m_symbols.declare(name.name, std::make_shared<TextFile>(std::move(stream), text));
}

std::shared_ptr<TextFile> Parser::fileHandle(NameId& name) {
    const Lexeme token = raw();
    Value* const value = token.kind == TokenKind::kName ? m_symbols.find(token.name) : nullptr;
    auto* const file = heldIn<std::shared_ptr<TextFile>>(value);
    if (file == nullptr) expected(token, "a file that #fopen has opened");
    name = token.name;
    return *file;
}

void Parser::closeFile() {
    // At its end a file was closed already.
    const Lexeme name = raw();
    if (name.kind != TokenKind::kName) expected(name, "an identifier");
    m_symbols.remove(name.name);
}

void Parser::readFromFile() {
    expectSymbol('(');
    NameId handle = 0;
    const auto file = fileHandle(handle);
    if (!file->isRead()) fail("#read of a file that is written");
    while (takeSymbol(',')) {
        const Lexeme name = raw();
        if (name.kind != TokenKind::kName) expected(name, "an identifier");
        auto value = valueIn(*file);
        const bool isAtEnd = file->source().tokens[file->at].kind == TokenKind::kEnd;
        if (!value && !isAtEnd)
            fail(fmt::format("{}: neither a float, a vector nor a string",
                             file->source().place(file->source().tokens[file->at]).text()));
        Value* const known = m_symbols.find(name.name);
        auto* const array = heldIn<std::shared_ptr<Array>>(known);
        if (array != nullptr && isSymbol(peek(), '[')) {
            const auto held = *array;
            Value* const to = element(*held);
            if (value) *to = std::move(*value);
        } else if (value) {
            m_symbols.declare(name.name, std::move(*value));
        }
    }
    expectSymbol(')');
    // A comma may end the last line.
    std::size_t at = file->at;
    const auto& tokens = file->source().tokens;
    if (tokens[at].kind == TokenKind::kSymbol && tokens[at].symbol == ',') ++at;
    if (tokens[at].kind == TokenKind::kEnd) m_symbols.remove(handle);
}

void Parser::writeToFile() {
    expectSymbol('(');
    NameId handle = 0;
    const auto file = fileHandle(handle);
    if (file->isRead()) fail("#write to a file that is read");
    while (!takeSymbol(')')) {
        if (takeSymbol(',')) continue;
        const Lexeme ahead = peek();
        const BinaryWord* words = nullptr;
        if (ahead.kind == TokenKind::kWord) {
            const auto found = std::ranges::find(kBinaryWords, wordOf(ahead), &BinaryWord::name);
            if (found != kBinaryWords.end()) words = &*found;
        }
        if (words != nullptr) {
            next();
            takeSymbol(',');
            const Numbers value = expression();
            for (std::size_t i = 0; i < value.size; ++i) file->write(binary(value.at[i], *words));
        } else if (beginsText(peek())) {
            file->write(text());
        } else {
            file->write(asWritten(expression()));
        }
    }
}

}  // namespace pm::host::pov
