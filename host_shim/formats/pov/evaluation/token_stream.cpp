// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Where the parser's tokens come from: files, include files and macros' bodies one in the other;
// directives are obeyed on the way.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "host_shim/formats/pov/evaluation/parser.h"
#include "host_shim/values/host_error.h"

namespace pm::host::pov {

Parser::Parser(Surroundings surroundings, Names& names)
    : m_around(std::move(surroundings)), m_names(names), m_version(m_around.version) {}
Parser::~Parser() = default;

Evaluated Parser::run(std::string_view text, const std::string& file) {
    m_begin = std::chrono::steady_clock::now();
    for (auto& [name, value] : m_around.declared) m_symbols.declare(m_names.id(name), value);
    auto source = cutIntoTokens(text, file, m_names, m_around.limits.tokensOfFile);
    m_sources.emplace(file, source);
    m_frames.push_back({std::move(source), 0, 0, {}, {}});
    Evaluated scene;
    while (true) {
        const Lexeme token = next();
        if (token.kind == TokenKind::kEnd) break;
        if (isSymbol(token, ';')) continue;
        // Before version 3 directives needed no # between statements.
        if (isWord(token, "declare") || isWord(token, "default") || isWord(token, "include") ||
            isWord(token, "version")) {
            directive(token);
            continue;
        }
        if (token.kind != TokenKind::kWord || m_names.use(token.name) != WordUse::kStatement)
            expected(token, "an object or a directive");
        scene.statements.push_back(statement(token));
    }
    scene.defaultTexture = m_defaultTexture;
    return scene;
}

void Parser::fail(const Place& place, const std::string& text) const {
    std::string around;
    constexpr std::size_t kMostShown = 8;
    for (std::size_t i = m_frames.size(); i-- > 1;) {
        const Frame& frame = m_frames[i];
        if (m_frames.size() - i > kMostShown) {
            around += "; ...";
            break;
        }
        around += fmt::format("; {} at {}",
                              frame.what.empty() ? "included" : "in " + frame.what + ", called",
                              frame.from.text());
    }
    throw HostError(ExitCode::kBadInput, fmt::format("{}: {}{}", place.text(), text, around));
}

void Parser::expected(const Lexeme& token, std::string_view what) const {
    fail(fmt::format("{} was expected, not {}", what, shown(token)));
}

std::string Parser::shown(const Lexeme& token) const {
    switch (token.kind) {
        case TokenKind::kEnd:
            return "the end of the file";
        case TokenKind::kNumber:
            return fmt::format("the number {}", token.number);
        case TokenKind::kString:
            return "a string";
        case TokenKind::kWord:
            return fmt::format("'{}'", wordOf(token));
        case TokenKind::kName:
            return fmt::format("the identifier '{}'", wordOf(token));
        case TokenKind::kDirective:
            return fmt::format("#{}", wordOf(token));
        case TokenKind::kSymbol:
            switch (token.symbol) {
                case static_cast<char>(Symbol::kLessEqual):
                    return "'<='";
                case static_cast<char>(Symbol::kGreaterEqual):
                    return "'>='";
                case static_cast<char>(Symbol::kNotEqual):
                    return "'!='";
                default:
                    return fmt::format("'{}'", token.symbol);
            }
        case TokenKind::kBad:
            break;
    }
    return token.source->strings[token.text];
}

Place Parser::placeOf(const Lexeme& token) const {
    return token.source == nullptr ? m_place : token.source->place(token);
}

void Parser::count() {
    constexpr std::uint64_t kBetweenQuestions = 1 << 12;
    if (++m_tokens % kBetweenQuestions != 0) return;
    if (m_around.goOn) m_around.goOn();
    const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - m_begin;
    if (taken.count() > m_around.limits.seconds)
        fail(fmt::format("reading the scene takes more than {:g} s", m_around.limits.seconds));
}

void Parser::countIteration() {
    if (++m_iterations > m_around.limits.iterations)
        fail(fmt::format("more than {} iterations and calls", m_around.limits.iterations));
}

Parser::Lexeme Parser::raw() {
    if (m_peeked) return *std::exchange(m_peeked, std::nullopt);
    count();
    Frame& current = frame();
    Lexeme token;
    static_cast<Token&>(token) = current.source->tokens[current.at];
    token.source = current.source.get();
    if (token.kind != TokenKind::kEnd) ++current.at;
    m_place = current.source->place(token);
    if (token.kind == TokenKind::kBad) fail(shown(token));
    return token;
}

Parser::Lexeme Parser::next() {
    while (true) {
        const bool wasPeeked = m_peeked.has_value();
        const Lexeme token = raw();
        if (wasPeeked) {
            m_place = placeOf(token);
            return token;
        }
        if (token.kind == TokenKind::kDirective) {
            if (m_isForOperator && hasToWait(token)) {
                --frame().at;
                return {};
            }
            const bool wasForOperator = std::exchange(m_isForOperator, false);
            directive(token);
            m_isForOperator = wasForOperator;
        } else if (token.kind == TokenKind::kEnd) {
            if (endOfText(token)) return token;
        } else if (token.kind == TokenKind::kName) {
            const Value* const value = m_symbols.find(token.name);
            const auto* const macro = heldIn<std::shared_ptr<const Macro>>(value);
            if (macro == nullptr) return token;
            const bool wasForOperator = std::exchange(m_isForOperator, false);
            callMacro(*macro, token);
            m_isForOperator = wasForOperator;
        } else {
            return token;
        }
    }
}

const Parser::Lexeme& Parser::peek() {
    if (!m_peeked) {
        const Place place = m_place;
        m_peeked = next();
        m_place = place;
    }
    return *m_peeked;
}

// An operator may be behind a directive, as in <1 #if (A) + 2 #end>; but not behind those that
// only declare or tell: they wait, so that they see what is declared here.
const Parser::Lexeme& Parser::peekOperator() {
    static const Lexeme kNone;
    if (m_peeked) return *m_peeked;
    const Place place = m_place;
    m_isForOperator = true;
    const Lexeme token = next();
    m_isForOperator = false;
    m_place = place;
    if (token.source == nullptr) return kNone;
    m_peeked = token;
    return *m_peeked;
}

bool Parser::hasToWait(const Lexeme& directive) const {
    constexpr std::array<std::string_view, 12> kWaiting{"declare", "local",  "undef",   "debug",
                                                        "warning", "error",  "fopen",   "read",
                                                        "write",   "fclose", "default", "macro"};
    return std::ranges::find(kWaiting, wordOf(directive)) != kWaiting.end();
}

bool Parser::isWord(const Lexeme& token, std::string_view word) const {
    return token.kind == TokenKind::kWord && wordOf(token) == word;
}

bool Parser::isBehind(char symbol) const {
    const Token& token = m_frames.back().source->tokens[m_frames.back().at];
    return token.kind == TokenKind::kSymbol && token.symbol == symbol;
}

bool Parser::takeSymbol(char symbol) {
    if (!isSymbol(peek(), symbol)) return false;
    next();
    return true;
}

bool Parser::takeWord(std::string_view word) {
    if (!isWord(peek(), word)) return false;
    next();
    return true;
}

void Parser::expectSymbol(char symbol) {
    const Lexeme token = next();
    if (!isSymbol(token, symbol)) expected(token, fmt::format("'{}'", symbol));
}

void Parser::enterSource(std::shared_ptr<const Source> source, std::size_t at, std::string what) {
    if (m_frames.size() >= m_around.limits.depth)
        fail(fmt::format("more than {} include files and macros in each other",
                         m_around.limits.depth));
    m_symbols.enter();
    m_frames.push_back({std::move(source), at, m_blocks.size(), std::move(what), m_place});
}

void Parser::leaveFrame() {
    m_blocks.resize(frame().firstBlock);
    m_frames.pop_back();
    m_symbols.leave();
}

// Whether it is the end of the scene.
bool Parser::endOfText(const Lexeme& token) {
    if (m_blocks.size() > frame().firstBlock) {
        const Token& opener = frame().source->tokens[m_blocks.back().opener];
        fail(placeOf(token),
             fmt::format("#{} of line {} has no #end", m_names.text(opener.name), opener.line));
    }
    if (m_frames.size() == 1) return true;
    leaveFrame();
    return false;
}

}  // namespace pm::host::pov
