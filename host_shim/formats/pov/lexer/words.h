// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>
#include <deque>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace pm::host::pov {

// A name of the language or of a scene, as a number. Reserved words come first, in the order of
// kWords of words.cpp.
using NameId = std::uint32_t;

// What a reserved word is to who reads expressions.
enum class WordUse : std::uint8_t {
    kDirective,        // after #
    kConstant,         // pi, yes, x, ...
    kVariable,         // clock, version, image_width, ...
    kNumberFunction,   // abs(...): a number or a vector
    kTextFunction,     // concat(...)
    kColour,           // color, colour
    kColourVector,     // rgb, srgbft, ...
    kColourComponent,  // red, filter, ...
    kStatement,        // all others: objects, what is in them, and their flags
};

// The names of one parse.
class Names {
  public:
    Names();

    NameId id(std::string_view name);  // also of new ones
    // Valid as long as this.
    const std::string& text(NameId id) const { return m_texts[id]; }
    bool isReserved(NameId id) const { return id < m_reserved; }
    // Of reserved words. The text lives as long as the program.
    std::string_view reserved(NameId id) const { return m_reservedTexts[id]; }
    WordUse use(NameId id) const { return m_uses[id]; }

  private:
    struct Hash {
        using is_transparent = void;
        std::size_t operator()(std::string_view text) const {
            return std::hash<std::string_view>{}(text);
        }
    };

    std::unordered_map<std::string, NameId, Hash, std::equal_to<>> m_ids;
    std::deque<std::string> m_texts;
    std::vector<std::string_view> m_reservedTexts;
    std::vector<WordUse> m_uses;
    NameId m_reserved{};
};

}  // namespace pm::host::pov
