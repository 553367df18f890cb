// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Identifiers, macros, include files, and what directives say.
#include <fmt/format.h>

#include <utility>

#include "host_shim/formats/pov/evaluation/parser.h"

namespace pm::host::pov {

// Behind a declaration, without asking what a directive after it does: it may use the name.
void Parser::takeSemicolon() {
    if (!isNext(';')) return;
    if (m_peeked)
        m_peeked.reset();
    else
        ++frame().at;
}

// An array of its own: what is put in one is not seen in the other.
Value Parser::own(Value value) {
    if (auto* const of = std::get_if<std::shared_ptr<Array>>(&value); of && of->use_count() > 1)
        value = std::make_shared<Array>(**of);
    return value;
}

void Parser::declareName(bool isLocal) {
    Lexeme name = raw();
    if (isWord(name, "deprecated")) {
        name = raw();
        if (isWord(name, "once")) name = raw();
        if (name.kind == TokenKind::kString) name = raw();
    }
    if (name.kind != TokenKind::kName) expected(name, "an identifier that is not reserved");
    // A macro that makes the value may not have ended yet when it is made.
    const std::uint32_t depth = m_symbols.depth();
    Value* const known = m_symbols.find(name.name);
    auto* const array = heldIn<std::shared_ptr<Array>>(known);
    if (array != nullptr && isSymbol(peek(), '[')) {
        std::shared_ptr<Array> held = *array;
        auto at = static_cast<std::size_t>(element(*held) - held->elements.data());
        while (isSymbol(peek(), '[')) {
            auto* const inner = std::get_if<std::shared_ptr<Array>>(&held->elements[at]);
            if (inner == nullptr) fail("an index of what is no array");
            held = std::shared_ptr<Array>(*inner);
            at = static_cast<std::size_t>(element(*held) - held->elements.data());
        }
        expectSymbol('=');
        Value value = own(rvalue());
        hold(held->depth, depthOf(value));
        held->elements[at] = std::move(value);
        return takeSemicolon();
    }
    expectSymbol('=');
    Value value = own(rvalue());
    if (auto* const of = std::get_if<std::shared_ptr<const Function>>(&value);
        of && (*of)->name.empty()) {
        auto named = std::make_shared<Function>(**of);
        named->name = wordOf(name);
        *of = std::move(named);
    }
    if (isLocal)
        m_symbols.declareLocal(name.name, std::move(value), depth);
    else
        m_symbols.declare(name.name, std::move(value));
    takeSemicolon();
}

void Parser::defineMacro() {
    const std::size_t opener = frame().at - 1;
    const Lexeme name = raw();
    if (name.kind != TokenKind::kName) expected(name, "an identifier that is not reserved");
    auto macro = std::make_shared<Macro>();
    macro->name = wordOf(name);
    Lexeme token = raw();
    if (!isSymbol(token, '(')) expected(token, "'('");
    for (token = raw(); !isSymbol(token, ')'); token = raw()) {
        if (isSymbol(token, ',')) continue;
        if (token.kind != TokenKind::kName) expected(token, "a parameter's name, ',' or ')'");
        macro->parameters.push_back(token.name);
    }
    macro->begin = frame().at;
    macro->end = endOf(opener);
    macro->source = frame().source;
    skipTo(macro->end + 1);
    m_symbols.declare(name.name, std::shared_ptr<const Macro>(std::move(macro)));
}

// What is handed over by its name alone may be changed by the macro.
Parser::Argument Parser::macroArgument() {
    if (peek().kind != TokenKind::kName) return {rvalue(), false, {}};
    const Lexeme name = next();
    const Symbols::Slot slot = m_symbols.slotOf(name.name);
    const Token& ahead = frame().source->tokens[frame().at];
    const bool isAlone = ahead.kind == TokenKind::kSymbol &&
                         (ahead.symbol == ',' || ahead.symbol == ')') &&
                         frame().source.get() == name.source;
    if (isAlone) return {{}, true, slot};
    m_peeked = name;
    return {rvalue(), false, {}};
}

void Parser::callMacro(const std::shared_ptr<const Macro>& called, const Lexeme& name) {
    const Deeper deeper(*this);
    const std::shared_ptr<const Macro> macro = called;
    countIteration();
    const Place place = placeOf(name);
    expectSymbol('(');
    std::vector<Argument> arguments;
    if (!takeSymbol(')')) {
        do arguments.push_back(macroArgument());
        while (takeSymbol(','));
        expectSymbol(')');
    }
    if (arguments.size() != macro->parameters.size())
        fail(place, fmt::format("macro {} of {} arguments; {} are wanted", macro->name,
                                arguments.size(), macro->parameters.size()));
    m_place = place;
    enterSource(macro->source, macro->begin, "macro " + macro->name);
    for (std::size_t i = 0; i < arguments.size(); ++i) {
        Argument& argument = arguments[i];
        if (argument.isReference)
            m_symbols.refer(macro->parameters[i], argument.slot);
        else
            m_symbols.declareLocal(macro->parameters[i], std::move(argument.value),
                                   m_symbols.depth());
    }
}

void Parser::include() {
    const std::string name = text(true);
    const auto file = m_around.find(name);
    if (!file) fail(fmt::format("'{}' is not found", name));
    auto& source = m_sources[*file];
    if (!source)
        source = cutIntoTokens(m_around.read(*file), *file, m_names, m_around.limits.tokensOfFile);
    enterSource(source, 0, {});
}

void Parser::setVersion() {
    m_version = number();
    takeSemicolon();
}

// What is said adds to what was the default before.
void Parser::setDefault() {
    auto node = std::make_shared<Node>();
    node->kind = "default";
    node->place = m_place;
    node->isBlock = true;
    if (m_defaultTexture) node->arguments.emplace_back(m_defaultTexture);
    expectSymbol('{');
    body(*node, '}');
    m_defaultTexture = std::move(node);
}

void Parser::message(const std::string& word) {
    const Place place = m_place;
    const std::string said = text();
    if (word == "error") fail(place, "#error: " + said);
    if (word == "warning") return m_around.warn(place, "#warning: " + said);
    m_around.debug(said);
}

}  // namespace pm::host::pov
