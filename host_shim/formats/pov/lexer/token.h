// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "host_shim/formats/pov/lexer/place.h"
#include "host_shim/formats/pov/lexer/words.h"

namespace pm::host::pov {

enum class TokenKind : std::uint8_t {
    kEnd,        // of the text
    kNumber,     //
    kString,     // text: index into Source::strings
    kWord,       // name: reserved
    kName,       // name: of the scene
    kDirective,  // name: the word after #; link: see Source
    kSymbol,     // symbol
    kBad,        // text: index into Source::strings of what is wrong, for when it is come to
};

// Symbols are their characters; of two characters these.
enum class Symbol : char {
    kLessEqual = 'l',
    kGreaterEqual = 'g',
    kNotEqual = 'n',
};

// A piece of a text. 24 bytes, since scenes of some 100 MB have 10^7 of them.
struct Token {
    TokenKind kind{TokenKind::kEnd};
    char symbol{};
    std::uint32_t line{};
    std::uint32_t column{};
    std::uint32_t link{};  // of a directive: the token of the next branch or end of its block
    union {
        double number;
        NameId name;
        std::uint32_t text;
    };
    Token() : number(0) {}
};

// A text as a whole, cut into tokens; the last is kEnd.
// Of #if and the like, link is the #elseif, #else, #case, #range or #end that follows in the same
// block, of those the next; 0 where there is none.
struct Source {
    std::shared_ptr<const std::string> file;  // as messages name it
    std::vector<Token> tokens;
    std::vector<std::string> strings;  // as they stand, without the quotes

    Place place(const Token& token) const { return {file, token.line, token.column}; }
};

// Cuts a text into tokens. What is no token becomes one of kBad. Errors: kBadInput when there are
// more than mostTokens.
std::shared_ptr<const Source> cutIntoTokens(std::string_view text, std::string file, Names& names,
                                            std::uint64_t mostTokens);

}  // namespace pm::host::pov
