// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include <fmt/format.h>

#include <charconv>
#include <string_view>
#include <utility>

#include "host_shim/formats/pov/lexer/token.h"
#include "host_shim/values/host_error.h"

namespace pm::host::pov {
namespace {

bool isDigit(char c) {
    return c >= '0' && c <= '9';
}
bool isLetter(char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
}

class Lexer {
  public:
    Lexer(std::string_view text, Names& names, Source& source, std::uint64_t mostTokens)
        : m_text(text), m_names(names), m_source(source), m_mostTokens(mostTokens) {
        if (m_text.starts_with("\xEF\xBB\xBF")) m_at = m_lineBegin = 3;
    }

    void run() {
        while (true) {
            skipBlanks();
            Token token;
            token.line = m_line;
            token.column = static_cast<std::uint32_t>(m_at - m_lineBegin + 1);
            if (m_at < m_text.size()) cut(token);
            m_source.tokens.push_back(token);
            if (token.kind == TokenKind::kEnd) return;
            if (token.kind == TokenKind::kDirective) linkBlock(m_source.tokens.size() - 1);
            if (m_source.tokens.size() > m_mostTokens)
                throw HostError(ExitCode::kBadInput, fmt::format("{}: more than {} tokens",
                                                                 *m_source.file, m_mostTokens));
        }
    }

  private:
    char look(std::size_t ahead = 0) const {
        return m_at + ahead < m_text.size() ? m_text[m_at + ahead] : '\0';
    }
    bool isAt(std::string_view text) const { return m_text.substr(m_at, text.size()) == text; }
    void newLine() {
        ++m_line;
        m_lineBegin = m_at;
    }

    // What makes a directive of a #, or a fault.
    static bool isBehindHash(char c) { return isLetter(c) || c == '#' || c == ' ' || c == '\t'; }

    // Comments are blanks; those in /* */ may hold others.
    void skipBlanks() {
        while (m_at < m_text.size()) {
            const char c = m_text[m_at];
            if (c == '\n' || (c == '\r' && look(1) != '\n')) {
                ++m_at;
                newLine();
            } else if (isAt("//")) {
                while (m_at < m_text.size() && m_text[m_at] != '\n' && m_text[m_at] != '\r') ++m_at;
            } else if (isAt("/*")) {
                skipComment();
            } else if (c == '#' && !isBehindHash(look(1))) {
                ++m_at;  // POV-Ray takes it for a blank
            } else if (static_cast<unsigned char>(c) <= ' ' || c == '\x7f') {
                ++m_at;  // NUL and other controls too, as old editors left them
            } else {
                return;
            }
        }
    }

    void skipComment() {
        std::size_t depth = 0;
        do {
            if (isAt("/*")) {
                ++depth;
                m_at += 2;
            } else if (isAt("*/")) {
                --depth;
                m_at += 2;
            } else if (m_text[m_at++] == '\n') {
                newLine();
            }
        } while (depth > 0 && m_at < m_text.size());
    }

    void cut(Token& token) {
        const char c = m_text[m_at];
        if (isDigit(c) || (c == '.' && isDigit(look(1)))) return number(token);
        if (isLetter(c)) return word(token);
        if (c == '"') return string(token);
        if (c == '#') return directive(token);
        constexpr std::pair<std::string_view, Symbol> kOfTwo[] = {
            {"<=", Symbol::kLessEqual}, {">=", Symbol::kGreaterEqual}, {"!=", Symbol::kNotEqual}};
        for (const auto& [text, symbol] : kOfTwo) {
            if (!isAt(text)) continue;
            m_at += 2;
            token.kind = TokenKind::kSymbol;
            token.symbol = static_cast<char>(symbol);
            return;
        }
        if (std::string_view("{}()[]<>,;:.+-*/=!&|?").find(c) == std::string_view::npos)
            return bad(token, 1,
                       c > ' ' && c <= '~' ? fmt::format("'{}' means nothing here", c)
                                           : fmt::format("a byte of {:#04x} means nothing here",
                                                         static_cast<unsigned char>(c)));
        ++m_at;
        token.kind = TokenKind::kSymbol;
        token.symbol = c;
    }

    void bad(Token& token, std::size_t size, std::string why) {
        m_at += size;
        token.kind = TokenKind::kBad;
        token.text = static_cast<std::uint32_t>(m_source.strings.size());
        m_source.strings.push_back(std::move(why));
    }

    void number(Token& token) {
        std::size_t end = m_at;
        const auto digits = [&] {
            while (end < m_text.size() && isDigit(m_text[end])) ++end;
        };
        digits();
        if (end < m_text.size() && m_text[end] == '.') {
            ++end;
            digits();
        }
        if (end < m_text.size() && (m_text[end] == 'e' || m_text[end] == 'E')) {
            std::size_t after = end + 1;
            if (after < m_text.size() && (m_text[after] == '+' || m_text[after] == '-')) ++after;
            if (after < m_text.size() && isDigit(m_text[after])) {
                end = after;
                digits();
            }
        }
        const char* const last = m_text.data() + end;
        token.number = 0;
        const auto result = std::from_chars(m_text.data() + m_at, last, token.number);
        if (result.ec == std::errc::result_out_of_range)
            return bad(token, end - m_at, "a number too large or too small");
        token.kind = TokenKind::kNumber;
        m_at = end;
    }

    std::string_view takeLetters() {
        const std::size_t begin = m_at;
        while (m_at < m_text.size() && (isLetter(m_text[m_at]) || isDigit(m_text[m_at]))) ++m_at;
        return m_text.substr(begin, m_at - begin);
    }

    void word(Token& token) {
        token.name = m_names.id(takeLetters());
        token.kind = m_names.isReserved(token.name) ? TokenKind::kWord : TokenKind::kName;
    }

    void string(Token& token) {
        std::size_t end = m_at + 1;
        while (end < m_text.size() && m_text[end] != '"') {
            // An escaped quote does not end it.
            end += m_text[end] == '\\' && end + 1 < m_text.size() ? 2 : 1;
        }
        if (end >= m_text.size())
            return bad(token, m_text.size() - m_at, "a string that nothing ends");
        token.kind = TokenKind::kString;
        token.text = static_cast<std::uint32_t>(m_source.strings.size());
        m_source.strings.emplace_back(m_text.substr(m_at + 1, end - m_at - 1));
        while (m_at <= end)
            if (m_text[m_at++] == '\n') newLine();
    }

    void directive(Token& token) {
        ++m_at;
        while (look() == ' ' || look() == '\t') ++m_at;
        if (look() == '#') return bad(token, 0, "# without the name of a directive");
        const std::string_view letters = takeLetters();
        if (letters.empty()) return bad(token, 0, "# without the name of a directive");
        token.name = m_names.id(letters);
        // version is a variable too.
        const bool isDirective =
            m_names.isReserved(token.name) &&
            (m_names.use(token.name) == WordUse::kDirective || letters == "version");
        if (!isDirective) return bad(token, 0, fmt::format("#{} is no directive", letters));
        token.kind = TokenKind::kDirective;
    }

    // Blocks nest; each of their directives knows the next.
    void linkBlock(std::size_t at) {
        const std::string& word = m_names.text(m_source.tokens[at].name);
        const bool opens = word == "if" || word == "ifdef" || word == "ifndef" || word == "while" ||
                           word == "for" || word == "switch" || word == "macro";
        if (opens) return m_open.push_back(at);
        const bool ends = word == "end";
        const bool branches =
            word == "else" || word == "elseif" || word == "case" || word == "range";
        if (m_open.empty() || (!ends && !branches)) return;
        m_source.tokens[m_open.back()].link = static_cast<std::uint32_t>(at);
        if (ends)
            m_open.pop_back();
        else
            m_open.back() = at;
    }

    std::string_view m_text;
    Names& m_names;
    Source& m_source;
    std::uint64_t m_mostTokens;
    std::size_t m_at = 0, m_lineBegin = 0;
    std::uint32_t m_line = 1;
    std::vector<std::size_t> m_open;  // the last directive of each block that is open
};

}  // namespace

std::shared_ptr<const Source> cutIntoTokens(std::string_view text, std::string file, Names& names,
                                            std::uint64_t mostTokens) {
    const auto source = std::make_shared<Source>();
    source->file = std::make_shared<const std::string>(std::move(file));
    Lexer(text, names, *source, mostTokens).run();
    return source;
}

}  // namespace pm::host::pov
