// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Floats, vectors and colours: the grammar of POV-Ray's manual, 3.3.1.5 to 3.3.1.7. Comparisons
// and what stands on them need parentheses, since < also begins a vector.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "host_shim/formats/pov/evaluation/parser.h"

namespace pm::host::pov {
namespace {

constexpr std::array<std::pair<std::string_view, Numbers>, 13> kConstants{{
    {"pi", {{std::numbers::pi}, 1, false}},
    {"true", {{1}, 1, false}},
    {"yes", {{1}, 1, false}},
    {"on", {{1}, 1, false}},
    {"false", {{0}, 1, false}},
    {"no", {{0}, 1, false}},
    {"off", {{0}, 1, false}},
    {"x", {{1, 0, 0}, 3, false}},
    {"y", {{0, 1, 0}, 3, false}},
    {"z", {{0, 0, 1}, 3, false}},
    {"t", {{0, 0, 0, 1}, 4, false}},
    {"u", {{1, 0}, 2, false}},
    {"v", {{0, 1}, 2, false}},
}};

}  // namespace

double Parser::number() {
    return expression().at[0];
}

Numbers Parser::expression(bool relations) {
    const Deeper deeper(*this);
    return relations ? conditional() : sum(nullptr);
}

// With its first operand already read.
Numbers Parser::expressionFrom(const Numbers& first) {
    const Deeper deeper(*this);
    return sum(&first);
}

Numbers Parser::conditional() {
    const Numbers value = logical();
    if (!isSymbol(peekOperator(), '?')) return value;
    next();
    const Numbers first = conditional();
    expectSymbol(':');
    const Numbers second = conditional();
    return std::abs(value.at[0]) > kEpsilon ? first : second;
}

Numbers Parser::logical() {
    Numbers value = relation();
    while (isSymbol(peekOperator(), '&') || isSymbol(peekOperator(), '|')) {
        const char op = next().symbol;
        value = combined(value, op, relation());
    }
    return value;
}

Numbers Parser::relation() {
    constexpr std::string_view kRelations = "<>=lgn";
    const auto isRelation = [&](const Lexeme& token) {
        return token.kind == TokenKind::kSymbol && kRelations.find(token.symbol) != kRelations.npos;
    };
    if (beginsText(peek())) {
        const std::string first = text();
        const Lexeme token = next();
        if (!isRelation(token)) expected(token, "a comparison of strings");
        const int order = first.compare(text());
        return combined(Numbers::of(order), token.symbol, Numbers::of(0));
    }
    Numbers value = sum(nullptr);
    while (isRelation(peekOperator())) {
        const char op = next().symbol;
        value = combined(value, op, sum(nullptr));
    }
    return value;
}

Numbers Parser::sum(const Numbers* first) {
    Numbers value = product(first);
    while (isSymbol(peekOperator(), '+') || isSymbol(peekOperator(), '-')) {
        const char op = next().symbol;
        value = combined(value, op, product(nullptr));
    }
    return value.isColour ? colourComponents(value) : value;
}

Numbers Parser::product(const Numbers* first) {
    Numbers value = first != nullptr ? withComponents(*first) : factor();
    while (isSymbol(peekOperator(), '*') || isSymbol(peekOperator(), '/')) {
        const char op = next().symbol;
        const Numbers by = factor();
        if (op == '/' && !m_warnedOfDivision &&
            std::any_of(by.at.begin(), by.at.begin() + by.size, [](double v) { return v == 0; })) {
            warn("division by zero");
            m_warnedOfDivision = true;
        }
        value = combined(value, op, by);
    }
    return value;
}

Numbers Parser::factor() {
    const Deeper deeper(*this);
    const Lexeme token = next();
    if (token.kind == TokenKind::kSymbol) {
        if (token.symbol == '-') return combined(Numbers::of(0), '-', factor());
        if (token.symbol == '+') return factor();
        if (token.symbol == '!') {
            Numbers value = factor();
            for (std::size_t i = 0; i < value.size; ++i)
                value.at[i] = std::abs(value.at[i]) <= kEpsilon ? 1 : 0;
            return value;
        }
    }
    return withComponents(operand(token));
}

// Behind an operand: .x and the like.
Numbers Parser::withComponents(Numbers value) {
    while (isSymbol(peekOperator(), '.')) {
        next();
        const Lexeme name = next();
        const std::size_t which =
            name.kind == TokenKind::kWord ? componentOf(wordOf(name)) : std::size_t{6};
        if (which == 6)
            expected(name, "x, y, z, t, u, v, red, green, blue, filter, transmit or gray");
        value = Numbers::of(which == 5 ? gray(value) : value.promoted(5).at[which]);
    }
    return value;
}

Numbers Parser::operand(const Lexeme& token) {
    switch (token.kind) {
        case TokenKind::kNumber:
            return Numbers::of(token.number);
        case TokenKind::kName:
            return operandOfName(token);
        case TokenKind::kWord:
            return operandOfWord(token);
        case TokenKind::kSymbol:
            if (token.symbol == '(') {
                const Numbers value = expression(true);
                expectSymbol(')');
                return value;
            }
            if (token.symbol == '<') {
                const std::vector<double> values = literal();
                if (values.size() < 2 || values.size() > 5)
                    fail(fmt::format("a vector of {} components; 2 to 5 are allowed",
                                     values.size()));
                return Numbers::vectorOf(values);
            }
            break;
        default:
            break;
    }
    expected(token, "a number, vector or colour");
}

// Behind <; commas may be missing, as POV-Ray has it.
std::vector<double> Parser::literal() {
    const Deeper deeper(*this);
    std::vector<double> values;
    while (true) {
        values.push_back(number());
        if (takeSymbol('>')) return values;
        takeSymbol(',');
        if (takeSymbol('>')) return values;
        if (values.size() > m_around.limits.elementsOfArrays) fail("a vector too long");
    }
}

Numbers Parser::operandOfName(const Lexeme& token) {
    Value* const value = resolved(token);
    if (value == nullptr) fail(fmt::format("'{}' is not declared", wordOf(token)));
    if (const auto* const numbers = std::get_if<Numbers>(value)) {
        // `Red filter 0.5` changes a component of it.
        return numbers->isColour ? colourComponents(*numbers) : *numbers;
    }
    if (const auto* const function = std::get_if<std::shared_ptr<const Function>>(value)) {
        const auto held = *function;
        return callFunction(*held);
    }
    if (const auto* const spline = std::get_if<std::shared_ptr<const Spline>>(value)) {
        const auto held = *spline;
        return callSpline(*held);
    }
    if (value->index() == 0)
        fail(fmt::format("an element of '{}' that nothing was put in", wordOf(token)));
    fail(fmt::format("a number, vector or colour was expected, and '{}' is {}", wordOf(token),
                     kindOf(*value)));
}

Numbers Parser::operandOfWord(const Lexeme& token) {
    const std::string& word = wordOf(token);
    switch (m_names.use(token.name)) {
        case WordUse::kConstant:
            return std::ranges::find(kConstants, word, [](const auto& c) { return c.first; })
                ->second;
        case WordUse::kVariable: {
            if (word == "version") return Numbers::of(m_version);
            const auto found = m_around.variables.find(word);
            return found == m_around.variables.end() ? Numbers::of(0) : found->second;
        }
        case WordUse::kNumberFunction:
            return numberFunction(token);
        case WordUse::kColour:
        case WordUse::kColourVector:
        case WordUse::kColourComponent:
            return colour(token);
        default:
            expected(token, "a number, vector or colour");
    }
}

// At color, rgb and the like, or a component. What is an expression goes on behind it.
Numbers Parser::colour(const Lexeme& token) {
    const std::string& word = wordOf(token);
    Numbers value = Numbers::colour(0, 0, 0, 0, 0);
    switch (m_names.use(token.name)) {
        case WordUse::kColour: {
            const Lexeme& ahead = peek();
            if (ahead.kind == TokenKind::kWord &&
                m_names.use(ahead.name) == WordUse::kColourComponent)
                break;
            value = expression().promoted(5);
            value.isColour = true;
            break;
        }
        case WordUse::kColourVector:
            value = colourVector(word);
            break;
        default: {
            m_peeked = token;  // the first of some components
            break;
        }
    }
    value = colourComponents(value);
    // POV-Ray keeps colours in single precision, and scenes print them.
    for (double& component : value.at) component = static_cast<float>(component);
    return value;
}

Numbers Parser::colourVector(const std::string& word) {
    const bool isEncoded = word[0] == 's';
    const std::string_view letters = std::string_view(word).substr(isEncoded ? 4 : 3);
    Numbers given = expression();
    given = given.promoted(3 + letters.size());
    Numbers value = Numbers::colour(given.at[0], given.at[1], given.at[2], 0, 0);
    for (std::size_t i = 0; i < letters.size(); ++i)
        value.at[letters[i] == 'f' ? 3 : 4] = given.at[3 + i];
    if (isEncoded)
        for (std::size_t i = 0; i < 3; ++i) {
            const double c = value.at[i];
            value.at[i] = c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
        }
    return value;
}

// Behind a colour: red 1 transmit 0.5 and the like.
Numbers Parser::colourComponents(Numbers value) {
    while (true) {
        const Lexeme& ahead = peekOperator();
        if (ahead.kind != TokenKind::kWord || m_names.use(ahead.name) != WordUse::kColourComponent)
            return value;
        const std::string word = wordOf(ahead);
        if (word == "gray") return value;
        next();
        value.at[word == "alpha" ? 3 : componentOf(word)] = number();
    }
}

}  // namespace pm::host::pov
