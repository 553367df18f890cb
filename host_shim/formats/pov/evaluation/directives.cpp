// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// #if and its like: what decides which tokens come next.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <utility>

#include "host_shim/formats/pov/evaluation/parser.h"

namespace pm::host::pov {

void Parser::directive(const Lexeme& token) {
    using Of = void (*)(Parser&, const Lexeme&);
    static constexpr std::array<std::pair<std::string_view, Of>, 26> kDirectives{{
        {"declare", [](Parser& p, const Lexeme&) { p.declareName(false); }},
        {"local", [](Parser& p, const Lexeme&) { p.declareName(true); }},
        {"end", [](Parser& p, const Lexeme&) { p.endBlock(); }},
        {"if", [](Parser& p, const Lexeme& t) { p.beginIf(t); }},
        {"ifdef", [](Parser& p, const Lexeme& t) { p.beginIf(t); }},
        {"ifndef", [](Parser& p, const Lexeme& t) { p.beginIf(t); }},
        {"else", [](Parser& p, const Lexeme& t) { p.branch(t); }},
        {"elseif", [](Parser& p, const Lexeme& t) { p.branch(t); }},
        {"case", [](Parser& p, const Lexeme& t) { p.branch(t); }},
        {"range", [](Parser& p, const Lexeme& t) { p.branch(t); }},
        {"while", [](Parser& p, const Lexeme&) { p.beginWhile(); }},
        {"for", [](Parser& p, const Lexeme&) { p.beginFor(); }},
        {"switch", [](Parser& p, const Lexeme&) { p.beginSwitch(); }},
        {"break", [](Parser& p, const Lexeme&) { p.breakOut(); }},
        {"macro", [](Parser& p, const Lexeme&) { p.defineMacro(); }},
        {"include", [](Parser& p, const Lexeme&) { p.include(); }},
        {"version", [](Parser& p, const Lexeme&) { p.setVersion(); }},
        {"default", [](Parser& p, const Lexeme&) { p.setDefault(); }},
        {"undef", [](Parser& p, const Lexeme&) { p.undefine(); }},
        {"fopen", [](Parser& p, const Lexeme&) { p.openFile(); }},
        {"fclose", [](Parser& p, const Lexeme&) { p.closeFile(); }},
        {"read", [](Parser& p, const Lexeme&) { p.readFromFile(); }},
        {"write", [](Parser& p, const Lexeme&) { p.writeToFile(); }},
        {"error", [](Parser& p, const Lexeme& t) { p.message(p.wordOf(t)); }},
        {"warning", [](Parser& p, const Lexeme& t) { p.message(p.wordOf(t)); }},
        {"debug", [](Parser& p, const Lexeme& t) { p.message(p.wordOf(t)); }},
    }};
    const Deeper deeper(*this);
    // The last stands for #render and #statistics too, which POV-Ray sends to the same place.
    const std::string& word = wordOf(token);
    auto found = std::ranges::find(kDirectives, word, [](const auto& d) { return d.first; });
    if (found == kDirectives.end()) --found;
    found->second(*this, token);
}

void Parser::undefine() {
    const Lexeme name = raw();
    if (name.kind != TokenKind::kName) expected(name, "an identifier");
    m_symbols.remove(name.name);
}

// The token of the #end of a block whose directive is at `opener`.
std::size_t Parser::endOf(std::size_t opener) const {
    const auto& tokens = m_frames.back().source->tokens;
    std::size_t at = opener;
    while (tokens[at].link != 0) at = tokens[at].link;
    if (at == opener || m_names.text(tokens[at].name) != "end")
        fail(m_frames.back().source->place(tokens[opener]),
             fmt::format("#{} has no #end", m_names.text(tokens[opener].name)));
    return at;
}

void Parser::open(Block::Kind kind) {
    Block block;
    block.kind = kind;
    block.opener = frame().at - 1;
    endOf(block.opener);
    m_blocks.push_back(block);
}

bool Parser::condition() {
    expectSymbol('(');
    const Numbers value = expression(true);
    expectSymbol(')');
    return std::abs(value.at[0]) > kEpsilon;
}

bool Parser::isDefined() {
    expectSymbol('(');
    const Lexeme name = raw();
    Value* value = nullptr;
    if (name.kind == TokenKind::kName) {
        value = m_symbols.find(name.name);
        auto* const array = heldIn<std::shared_ptr<Array>>(value);
        if (array != nullptr && isSymbol(peek(), '[')) value = element(**array);
    } else if (name.kind != TokenKind::kWord) {
        expected(name, "an identifier");
    }
    expectSymbol(')');
    return value != nullptr && value->index() != 0;
}

void Parser::beginIf(const Lexeme& token) {
    open(Block::Kind::kIf);
    const std::size_t opener = m_blocks.back().opener, depth = m_blocks.size();
    const bool isTrue =
        wordOf(token) == "if" ? condition() : isDefined() == (wordOf(token) == "ifdef");
    if (m_blocks.size() != depth) fail("blocks begin or end within a condition");
    m_blocks.back().isTaken = isTrue;
    if (!isTrue) takeBranch(frame().source->tokens[opener].link);
}

// Goes to a branch that was not asked yet; the next token read is of what it decides.
void Parser::takeBranch(std::size_t at) {
    while (true) {
        const Token token = frame().source->tokens[at];
        const std::string& word = m_names.text(token.name);
        skipTo(word == "end" ? at : at + 1);
        if (word == "end") return;
        m_blocks.back().isTaken = true;
        if (word == "else" || (word == "elseif" && condition())) return;
        m_blocks.back().isTaken = false;
        at = token.link;
    }
}

// The branch before was taken to its end, or a clause of a #switch is come to.
void Parser::branch(const Lexeme& token) {
    if (m_blocks.size() == frame().firstBlock)
        fail(fmt::format("#{} outside of a block", wordOf(token)));
    const Block block = m_blocks.back();
    if (block.kind == Block::Kind::kSwitch) {
        // What no #break ends goes on in the next clause, as POV-Ray has it.
        if (wordOf(token) != "else") clause(wordOf(token) == "range");
        return;
    }
    if (block.kind != Block::Kind::kIf) fail(fmt::format("#{} in a loop", wordOf(token)));
    skipTo(endOf(block.opener));
}

void Parser::beginSwitch() {
    open(Block::Kind::kSwitch);
    const std::size_t opener = m_blocks.back().opener;
    expectSymbol('(');
    m_blocks.back().value = number();
    expectSymbol(')');
    skipTo(frame().source->tokens[opener].link);
    chooseClause();
}

// Whether the value of the #switch is what a clause asks for.
bool Parser::clause(bool isRange) {
    expectSymbol('(');
    const double value = m_blocks.back().value, low = number();
    double high = low;
    if (isRange) {
        expectSymbol(',');
        high = number();
    }
    expectSymbol(')');
    return low <= value + kEpsilon && value <= high + kEpsilon;
}

// From the clause that is next: the first that holds, or the #end.
void Parser::chooseClause() {
    while (true) {
        const std::size_t at = frame().at;
        const Token token = frame().source->tokens[at];
        const std::string& word = m_names.text(token.name);
        if (word == "end") return;
        skipTo(at + 1);
        if (word == "else") return;
        if (clause(word == "range")) return;
        skipTo(token.link);
    }
}

void Parser::beginWhile() {
    open(Block::Kind::kWhile);
    const std::size_t index = m_blocks.size() - 1;
    m_blocks[index].isTaken = condition();
    if (!m_blocks[index].isTaken) skipTo(endOf(m_blocks[index].opener));
}

void Parser::beginFor() {
    open(Block::Kind::kFor);
    const std::size_t index = m_blocks.size() - 1;
    expectSymbol('(');
    const Lexeme name = raw();
    if (name.kind != TokenKind::kName) expected(name, "an identifier");
    expectSymbol(',');
    const double begin = number();
    expectSymbol(',');
    const double end = number();
    double step = 1;
    if (takeSymbol(',')) step = number();
    expectSymbol(')');
    if (std::abs(step) < kEpsilon) fail("#for with a step of 0");
    Block& block = m_blocks[index];
    block.variable = name.name;
    block.end = end;
    block.step = step;
    m_symbols.declareLocal(name.name, Numbers::of(begin), m_symbols.depth());
    block.isTaken = step > 0 ? begin <= end + kEpsilon : begin >= end - kEpsilon;
    if (!block.isTaken) skipTo(endOf(block.opener));
}

void Parser::endBlock() {
    if (m_blocks.size() == frame().firstBlock) {
        if (frame().what.empty()) fail("#end without a block");
        return leaveFrame();
    }
    Block& block = m_blocks.back();
    const bool loops = block.kind == Block::Kind::kWhile || block.kind == Block::Kind::kFor;
    if (!loops || !block.isTaken) return m_blocks.pop_back();
    countIteration();
    const std::size_t opener = block.opener;
    if (block.kind == Block::Kind::kWhile) {
        m_blocks.pop_back();
        skipTo(opener + 1);
        return beginWhile();
    }
    const Value* const value = m_symbols.find(block.variable);
    const auto* const counter = heldIn<Numbers>(value);
    if (counter == nullptr)
        fail(
            fmt::format("'{}', which #for counts with, is no float", m_names.text(block.variable)));
    const double next = counter->at[0] + block.step;
    m_symbols.declareLocal(block.variable, Numbers::of(next), m_symbols.depth());
    if (block.step > 0 ? next > block.end + kEpsilon : next < block.end - kEpsilon)
        return m_blocks.pop_back();
    skipTo(opener + 1);
    // Behind what #for has in parentheses.
    for (int depth = 0;;) {
        const Token& token = frame().source->tokens[frame().at++];
        if (token.kind != TokenKind::kSymbol) continue;
        depth += token.symbol == '(' ? 1 : token.symbol == ')' ? -1 : 0;
        if (depth == 0) return;
    }
}

// Out of the innermost loop or #switch, else out of the macro.
void Parser::breakOut() {
    while (m_blocks.size() > frame().firstBlock) {
        const Block block = m_blocks.back();
        if (block.kind != Block::Kind::kIf) {
            skipTo(endOf(block.opener));
            m_blocks.back().isTaken = false;
            return;
        }
        m_blocks.pop_back();
    }
    if (frame().what.empty()) fail("#break outside of a loop, a #switch and a macro");
    leaveFrame();
}

}  // namespace pm::host::pov
