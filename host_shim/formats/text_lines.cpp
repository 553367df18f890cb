// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/formats/text_lines.h"

#include <charconv>
#include <limits>

namespace pm::host {
namespace {

constexpr std::string_view kBlanks = " \t\v\f";

template <typename T>
std::from_chars_result parseWhole(std::string_view word, T& value) {
    if (word.starts_with('+')) word.remove_prefix(1);
    return std::from_chars(word.data(), word.data() + word.size(), value);
}

}  // namespace

std::string_view trimmed(std::string_view text) {
    const auto first = text.find_first_not_of(kBlanks);
    if (first == std::string_view::npos) return {};
    return text.substr(first, text.find_last_not_of(kBlanks) - first + 1);
}

std::string_view takeWord(std::string_view& text) {
    text = trimmed(text);
    const auto end = std::min(text.find_first_of(kBlanks), text.size());
    const std::string_view word = text.substr(0, end);
    text = trimmed(text.substr(end));
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
    const auto end = std::min(m_rest.find_first_of("\r\n"), m_rest.size());
    const std::string_view line = m_rest.substr(0, end);
    m_rest.remove_prefix(end);
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
