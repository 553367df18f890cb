// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// What may stand behind #declare NAME =, and as a macro's argument.
#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "host_shim/formats/pov/evaluation/parser.h"

namespace pm::host::pov {

bool Parser::beginsNumbers(const Lexeme& token) {
    switch (token.kind) {
        case TokenKind::kNumber:
            return true;
        case TokenKind::kSymbol:
            return std::string_view("<(-+!").find(token.symbol) != std::string_view::npos;
        case TokenKind::kWord: {
            const WordUse use = m_names.use(token.name);
            return use == WordUse::kConstant || use == WordUse::kVariable ||
                   use == WordUse::kNumberFunction || use == WordUse::kColour ||
                   use == WordUse::kColourVector || use == WordUse::kColourComponent;
        }
        default:
            return false;
    }
}

bool Parser::beginsText(const Lexeme& token) {
    if (token.kind == TokenKind::kString) return true;
    if (token.kind == TokenKind::kWord)
        return m_names.use(token.name) == WordUse::kTextFunction ||
               wordOf(token) == "input_file_name";
    if (token.kind != TokenKind::kName) return false;
    const Value* value = m_symbols.find(token.name);
    // Of an array the elements are alike; without [ ] it is meant as a whole.
    if (const auto* const array = heldIn<std::shared_ptr<Array>>(value)) {
        if (!isBehind('[')) return false;
        const auto found =
            std::ranges::find_if((*array)->elements, [](const Value& v) { return v.index() != 0; });
        value = found == (*array)->elements.end() ? nullptr : &*found;
    }
    return value != nullptr && std::holds_alternative<std::string>(*value);
}

// The value of an element whose indices come next.
Value* Parser::element(Array& array) {
    const Deeper deeper(*this);
    std::size_t at = 0;
    for (std::size_t d = 0; d < array.sizes.size(); ++d) {
        expectSymbol('[');
        const double index = number();
        expectSymbol(']');
        if (!(index > -1 && index < array.sizes[d]))
            fail(fmt::format("index {} of an array of {}", index, array.sizes[d]));
        at = at * array.sizes[d] + static_cast<std::size_t>(std::max(0.0, index));
    }
    return &array.elements[at];
}

// nullptr: not declared. An array's element by the indices behind it, if there are some.
Value* Parser::resolved(const Lexeme& name) {
    Value* value = m_symbols.find(name.name);
    while (value != nullptr) {
        auto* const array = std::get_if<std::shared_ptr<Array>>(value);
        // Not peeked for: where the table of a macro ends, so would the value.
        if (array == nullptr || !isNext('[')) return value;
        const std::shared_ptr<Array> held = *array;
        value = element(*held);
    }
    return nullptr;
}

Value Parser::rvalue() {
    const Deeper deeper(*this);
    const Lexeme& ahead = peek();
    if (beginsText(ahead)) return text();
    if (beginsNumbers(ahead)) return expression();
    const Lexeme token = next();
    if (token.kind == TokenKind::kWord) {
        if (auto value = rvalueOfWord(token)) return std::move(*value);
        expected(token, "a value");
    }
    if (token.kind != TokenKind::kName) expected(token, "a value");
    const Value* const value = resolved(token);
    if (value == nullptr) fail(fmt::format("'{}' is not declared", wordOf(token)));
    if (const auto* const numbers = std::get_if<Numbers>(value)) {
        const Numbers first = *numbers;
        return expressionFrom(first.isColour ? colourComponents(first) : first);
    }
    const Value held = *value;
    if (isSymbol(peekOperator(), '(')) {
        if (const auto* const f = std::get_if<std::shared_ptr<const Function>>(&held))
            return expressionFrom(callFunction(**f));
        if (const auto* const s = std::get_if<std::shared_ptr<const Spline>>(&held))
            return expressionFrom(callSpline(**s));
    }
    if (held.index() == 0)
        fail(fmt::format("an element of '{}' that nothing was put in", wordOf(token)));
    return held;
}

std::optional<Value> Parser::rvalueOfWord(const Lexeme& token) {
    const std::string& word = wordOf(token);
    if (word == "array") return arrayValue();
    if (word == "spline") return splineValue();
    if (word == "function") return functionValue();
    if (m_names.use(token.name) != WordUse::kStatement) return std::nullopt;
    return statement(token);
}

std::shared_ptr<Array> Parser::arrayValue() {
    auto array = std::make_shared<Array>();
    std::uint64_t count = 1;
    while (isNext('[')) {
        next();
        const double size = number();
        expectSymbol(']');
        if (!(size >= 1 && size <= static_cast<double>(m_around.limits.elementsOfArrays)))
            fail(fmt::format("an array of {} elements; 1 to {} are allowed", size,
                             m_around.limits.elementsOfArrays));
        array->sizes.push_back(static_cast<std::uint32_t>(size));
        count *= static_cast<std::uint64_t>(size);
        if (count > m_around.limits.elementsOfArrays)
            fail(
                fmt::format("an array of more than {} elements", m_around.limits.elementsOfArrays));
    }
    if (array->sizes.empty()) fail("an array without [SIZE]");
    m_elements += count;
    if (m_elements > m_around.limits.elementsOfArrays)
        fail(fmt::format("arrays of more than {} elements together",
                         m_around.limits.elementsOfArrays));
    array->elements.resize(count);
    std::size_t at = 0;
    if (isNext('{')) {
        next();
        arrayElements(*array, 0, at);
    }
    return array;
}

// Behind {, of a dimension.
void Parser::arrayElements(Array& array, std::size_t dimension, std::size_t& at) {
    const Deeper deeper(*this);
    std::size_t stride = 1;
    for (std::size_t d = dimension + 1; d < array.sizes.size(); ++d) stride *= array.sizes[d];
    const std::size_t begin = at;
    for (std::uint32_t i = 0; !takeSymbol('}'); ++i) {
        if (takeSymbol(',')) {
            --i;
            continue;
        }
        if (i >= array.sizes[dimension])
            fail(fmt::format("more elements than the array's {}", array.sizes[dimension]));
        at = begin + i * stride;
        if (dimension + 1 < array.sizes.size()) {
            expectSymbol('{');
            arrayElements(array, dimension + 1, at);
        } else {
            array.elements[at] = rvalue();
            hold(array.depth, depthOf(array.elements[at]));
        }
    }
    at = begin + stride * array.sizes[dimension];
}

std::shared_ptr<const Spline> Parser::splineValue() {
    const Deeper deeper(*this);
    auto spline = std::make_shared<Spline>();
    expectSymbol('{');
    while (!takeSymbol('}')) {
        if (takeSymbol(',')) continue;
        const Lexeme ahead = peek();
        if (ahead.kind == TokenKind::kWord && splineKindOf(wordOf(ahead), spline->kind)) {
            next();
            continue;
        }
        const Value* const value =
            ahead.kind == TokenKind::kName ? m_symbols.find(ahead.name) : nullptr;
        const auto* const other = heldIn<std::shared_ptr<const Spline>>(value);
        if (other != nullptr) {
            *spline = **other;
            next();
            continue;
        }
        Spline::Point point;
        point.parameter = number();
        takeSymbol(',');
        point.value = expression();
        spline->add(point);
    }
    return spline;
}

}  // namespace pm::host::pov
