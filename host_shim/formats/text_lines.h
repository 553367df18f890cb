// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace pm::host {

// Walks over the lines of an OBJ or MTL text: skips a byte order mark, joins lines that end in a
// backslash, drops comments, surrounding blanks and empty lines. Ends of lines may be LF, CR LF or
// CR.
class TextLines {
  public:
    explicit TextLines(std::string_view text);

    // Moves to the next line that says something; false at the end.
    bool next();
    std::string_view line() const { return m_line; }
    std::uint64_t number() const { return m_number; }  // from 1; the first of joined lines

  private:
    std::string_view takePhysicalLine();

    std::string_view m_rest;
    std::string_view m_line;
    std::string m_joined;
    std::uint64_t m_nextNumber{1};
    std::uint64_t m_number{};
};

// Takes the first word, up to a blank, off the front of text; empty when there is none.
std::string_view takeWord(std::string_view& text);
std::string_view trimmed(std::string_view text);

// A number with a dot in any locale. False when word is not a number as a whole. Too large gives
// infinity, too small 0; "nan" and "inf" are numbers here, finite or not is for the caller to ask.
bool parseNumber(std::string_view word, double& value);
bool parseInteger(std::string_view word, std::int64_t& value);

}  // namespace pm::host
