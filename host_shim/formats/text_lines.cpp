// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/formats/text_lines.h"

#include <algorithm>
#include <charconv>
#include <limits>

namespace pm::host {
namespace {

bool isBlank(char c) {
    return c == ' ' || c == '\t' || c == '\v' || c == '\f';
}
bool isEnd(char c) {
    return c == '\n' || c == '\r';
}

template <typename T>
std::from_chars_result parseWhole(std::string_view word, T& value) {
    if (word.starts_with('+')) word.remove_prefix(1);
    return std::from_chars(word.data(), word.data() + word.size(), value);
}

}  // namespace

std::string_view trimmed(std::string_view text) {
    // std::string_view's own searches for one of several characters call memchr for each.
    while (!text.empty() && isBlank(text.front())) text.remove_prefix(1);
    while (!text.empty() && isBlank(text.back())) text.remove_suffix(1);
    return text;
}

std::string_view takeWord(std::string_view& text) {
    text = trimmed(text);
    const auto end = std::find_if(text.begin(), text.end(), isBlank);
    const std::string_view word(text.begin(), end);
    text = trimmed({end, text.end()});
    return word;
}

bool parseNumber(std::string_view word, double& value) {
    const auto result = parseWhole(word, value);
    if (result.ptr != word.data() + word.size()) return false;
    if (result.ec == std::errc::result_out_of_range) {
        const bool small = word.find("e-") != word.npos || word.find("E-") != word.npos;
        value = small ? 0.0 : std::numeric_limits<double>::infinity();
        return true;
    }
    return result.ec == std::errc{};
}

bool parseInteger(std::string_view word, std::int64_t& value) {
    const auto result = parseWhole(word, value);
    return result.ec == std::errc{} && result.ptr == word.data() + word.size();
}

TextLines::TextLines(std::string_view text) : m_rest(text) {
    if (m_rest.starts_with("\xEF\xBB\xBF")) m_rest.remove_prefix(3);
}

std::string_view TextLines::takePhysicalLine() {
    const std::string_view line(m_rest.begin(), std::find_if(m_rest.begin(), m_rest.end(), isEnd));
    m_rest.remove_prefix(line.size());
    if (m_rest.starts_with("\r\n")) m_rest.remove_prefix(1);
    if (!m_rest.empty()) m_rest.remove_prefix(1);
    ++m_nextNumber;
    return line;
}

bool TextLines::next() {
    while (!m_rest.empty()) {
        m_number = m_nextNumber;
        m_line = takePhysicalLine();
        if (m_line.ends_with('\\') && !trimmed(m_line).starts_with('#')) {
            m_joined.assign(m_line);
            while (m_joined.ends_with('\\')) {
                m_joined.back() = ' ';
                if (m_rest.empty()) break;
                m_joined += takePhysicalLine();
            }
            m_line = m_joined;
        }
        m_line = trimmed(m_line);
        if (!m_line.empty() && !m_line.starts_with('#')) return true;
    }
    return false;
}

}  // namespace pm::host
