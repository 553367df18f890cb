// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// What is in the braces of function { ... }; POV-Ray's manual, 3.3.1.8.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "host_shim/formats/pov/evaluation/parser.h"

namespace pm::host::pov {

// Reads an expression into terms; names are the function's parameters first.
class Parser::FunctionReader {
  public:
    FunctionReader(Parser& parser, Function& function)
        : m_parser(parser), m_variables(function.parameters), m_depth(function.depth) {}

    // | binds least, then &, comparisons, sums and products.
    FunctionTerm read(std::size_t level = 0) {
        const Deeper deeper(m_parser);
        if (level == kLevels.size()) return factor();
        FunctionTerm term = read(level + 1);
        while (true) {
            const Lexeme& ahead = m_parser.peekOperator();
            if (ahead.kind != TokenKind::kSymbol ||
                kLevels[level].find(ahead.symbol) == std::string_view::npos)
                return term;
            FunctionTerm operation;
            operation.kind = FunctionTerm::Kind::kOperation;
            operation.text = m_parser.next().symbol;
            operation.terms.push_back(std::move(term));
            operation.terms.push_back(read(level + 1));
            term = std::move(operation);
        }
    }

  private:
    static constexpr std::array<std::string_view, 5> kLevels{"|", "&", "<>=lgn", "+-", "*/"};

    static FunctionTerm constant(double value) {
        FunctionTerm term;
        term.number = value;
        return term;
    }

    FunctionTerm factor() {
        const Deeper deeper(m_parser);
        const Lexeme token = m_parser.next();
        if (m_parser.isSymbol(token, '+')) return factor();
        if (m_parser.isSymbol(token, '-') || m_parser.isSymbol(token, '!')) {
            FunctionTerm term;
            term.kind = FunctionTerm::Kind::kOperation;
            term.text = token.symbol;
            term.terms.push_back(factor());
            return term;
        }
        if (m_parser.isSymbol(token, '(')) {
            FunctionTerm term = read();
            m_parser.expectSymbol(')');
            return term;
        }
        if (token.kind == TokenKind::kNumber) return constant(token.number);
        if (token.kind == TokenKind::kName || token.kind == TokenKind::kWord) return name(token);
        if (m_parser.isSymbol(token, '<')) {
            m_parser.m_peeked = token;
            return constant(m_parser.expression().at[0]);
        }
        m_parser.expected(token, "a term of a function");
    }

    // x and u are the same, and y and v.
    std::optional<std::uint32_t> variable(const std::string& name) const {
        constexpr std::array<std::pair<std::string_view, std::string_view>, 4> kAlike{
            {{"x", "u"}, {"u", "x"}, {"y", "v"}, {"v", "y"}}};
        for (std::size_t i = m_variables.size(); i-- > 0;)
            if (m_variables[i] == name) return static_cast<std::uint32_t>(i);
        for (const auto& [written, meant] : kAlike)
            if (written == name)
                for (std::size_t i = 0; i < m_variables.size(); ++i)
                    if (m_variables[i] == meant) return static_cast<std::uint32_t>(i);
        return std::nullopt;
    }

    FunctionTerm name(const Lexeme& token) {
        const std::string word = m_parser.wordOf(token);
        if (const auto index = variable(word)) {
            FunctionTerm term;
            term.kind = FunctionTerm::Kind::kParameter;
            term.index = *index;
            term.text = word;
            return term;
        }
        if (token.kind == TokenKind::kWord) {
            std::size_t least = 0, most = 0;
            if (isFunctionBuiltIn(word, least, most)) return builtInTerm(word, least, most);
            m_parser.m_peeked = token;
            return constant(m_parser.factor().at[0]);
        }
        Value* const value = m_parser.resolved(token);
        if (value == nullptr) m_parser.fail(fmt::format("'{}' is not declared", word));
        if (const auto* const function = std::get_if<std::shared_ptr<const Function>>(value))
            return component(call(*function));
        if (const auto* const spline = std::get_if<std::shared_ptr<const Spline>>(value)) {
            auto of = std::make_shared<Function>();
            of->spline = *spline;
            of->name = word;
            return component(call(of));
        }
        if (const auto* const numbers = std::get_if<Numbers>(value)) {
            const Numbers held = *numbers;
            return constant(m_parser.withComponents(held).at[0]);
        }
        m_parser.fail(fmt::format("'{}' is {}, which functions can't use", word, kindOf(*value)));
    }

    FunctionTerm builtInTerm(const std::string& word, std::size_t least, std::size_t most) {
        FunctionTerm term;
        term.kind = FunctionTerm::Kind::kBuiltIn;
        term.text = word;
        m_parser.expectSymbol('(');
        const bool repeats = word == "sum" || word == "prod";
        if (repeats) {
            const Lexeme variable = m_parser.next();
            if (variable.kind != TokenKind::kName && variable.kind != TokenKind::kWord)
                m_parser.expected(variable, "the name of a variable");
            m_parser.expectSymbol(',');
            term.terms.push_back(read());
            m_parser.expectSymbol(',');
            term.terms.push_back(read());
            m_parser.expectSymbol(',');
            term.index = static_cast<std::uint32_t>(m_variables.size());
            m_variables.push_back(m_parser.wordOf(variable));
            term.terms.push_back(read());
            m_variables.pop_back();
        } else {
            do term.terms.push_back(read());
            while (m_parser.takeSymbol(','));
            if (term.terms.size() < least || term.terms.size() > most)
                m_parser.fail(fmt::format("{} of {} arguments", word, term.terms.size()));
        }
        m_parser.expectSymbol(')');
        return term;
    }

    FunctionTerm call(const std::shared_ptr<const Function>& function) {
        m_parser.hold(m_depth, function->depth);
        FunctionTerm term;
        term.kind = FunctionTerm::Kind::kCall;
        term.function = function;
        term.text = function->name;
        m_parser.expectSymbol('(');
        if (!m_parser.takeSymbol(')')) {
            do term.terms.push_back(read());
            while (m_parser.takeSymbol(','));
            m_parser.expectSymbol(')');
        }
        if (!function->takes(term.terms.size()))
            m_parser.fail(fmt::format("function {} of {} arguments; {} are wanted", function->name,
                                      term.terms.size(), function->arity()));
        return term;
    }

    FunctionTerm component(FunctionTerm of) {
        if (!m_parser.isSymbol(m_parser.peekOperator(), '.')) return of;
        m_parser.next();
        const Lexeme word = m_parser.next();
        FunctionTerm term;
        term.kind = FunctionTerm::Kind::kComponent;
        term.text = word.kind == TokenKind::kWord ? m_parser.wordOf(word) : "";
        const std::size_t which = componentOf(term.text);
        if (which == 6) m_parser.expected(word, "x, y, z, t, u, v, red, green, blue, ... or gray");
        term.index = static_cast<std::uint32_t>(which);
        term.terms.push_back(std::move(of));
        return term;
    }

    Parser& m_parser;
    std::vector<std::string> m_variables;
    std::uint32_t& m_depth;
};

// Behind `function`.
std::shared_ptr<const Function> Parser::functionValue() {
    const Deeper deeper(*this);
    auto function = std::make_shared<Function>();
    function->parameters = {"x", "y", "z"};
    if (takeSymbol('(')) {
        function->parameters.clear();
        while (!takeSymbol(')')) {
            const Lexeme name = raw();
            if (isSymbol(name, ',')) continue;
            if (name.kind != TokenKind::kName && name.kind != TokenKind::kWord)
                expected(name, "a parameter's name");
            function->parameters.push_back(wordOf(name));
        }
    }
    expectSymbol('{');
    const Lexeme ahead = peek();
    const std::string word = ahead.kind == TokenKind::kWord ? wordOf(ahead) : std::string();
    if (word == "internal") {
        next();
        expectSymbol('(');
        function->internal = static_cast<int>(std::clamp(number(), 0.0, 1000.0));
        expectSymbol(')');
    } else if (word == "pattern" || word == "pigment" || word == "transform") {
        function->node = statement(next());
        hold(function->depth, function->node->depth);
    } else if (word == "spline") {
        next();
        function->spline = splineValue();
    } else {
        function->expression = FunctionReader(*this, *function).read();
    }
    expectSymbol('}');
    return function;
}

}  // namespace pm::host::pov
