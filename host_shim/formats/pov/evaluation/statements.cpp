// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Statements: a reserved word and what is between its braces. Which words mean something where is
// asked by who uses a node; here keywords take the values that follow them.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "host_shim/formats/pov/evaluation/parser.h"

namespace pm::host::pov {
namespace {

// Keywords behind which values are none of theirs but of the statement that they stand in: most
// arguments.
constexpr std::array<std::pair<std::string_view, std::size_t>, 22> kMostArguments{{
    {"linear_spline", 0}, {"quadratic_spline", 0}, {"cubic_spline", 0}, {"natural_spline", 0},
    {"bezier_spline", 0}, {"b_spline", 0},         {"linear_sweep", 0}, {"conic_sweep", 0},
    {"quaternion", 0},    {"hypercomplex", 0},     {"u_steps", 1},      {"v_steps", 1},
    {"type", 1},          {"flatness", 1},         {"accuracy", 1},     {"max_gradient", 1},
    {"threshold", 1},     {"tolerance", 1},        {"precision", 1},    {"sqr", 0},
    {"cube", 0},          {"inside_vector", 1},
}};

// Written in two ways.
constexpr std::array<std::pair<std::string_view, std::string_view>, 4> kSpellings{{
    {"colour_map", "color_map"},
    {"quick_colour", "quick_color"},
    {"fade_colour", "fade_color"},
    {"use_colour", "use_color"},
}};

std::size_t mostArguments(std::string_view kind) {
    const auto found =
        std::ranges::find(kMostArguments, kind, [](const auto& entry) { return entry.first; });
    return found == kMostArguments.end() ? static_cast<std::size_t>(-1) : found->second;
}

}  // namespace

std::shared_ptr<Node> Parser::begunNode(const Lexeme& word) {
    auto node = std::make_shared<Node>();
    node->kind = m_names.reserved(word.name);
    for (const auto& [written, meant] : kSpellings)
        if (node->kind == written) node->kind = meant;
    node->place = placeOf(word);
    return node;
}

// With its braces.
Parser::NodePtr Parser::statement(const Lexeme& word) {
    const Deeper deeper(*this);
    const auto node = begunNode(word);
    const Lexeme brace = next();
    if (!isSymbol(brace, '{')) expected(brace, fmt::format("'{{' behind {}", node->kind));
    node->isBlock = true;
    body(*node, '}');
    return node;
}

void Parser::body(Node& node, char closing) {
    const Deeper deeper(*this);
    std::shared_ptr<Node> open;  // the last keyword, while values may be its own
    while (true) {
        const Lexeme& ahead = peek();
        if (isSymbol(ahead, closing)) {
            next();
            return;
        }
        if (isSymbol(ahead, ',') || isSymbol(ahead, ';')) {
            next();
        } else if (isSymbol(ahead, '[')) {
            const Lexeme token = next();
            auto entry = std::make_shared<Node>();
            entry->kind = "[";
            entry->place = placeOf(token);
            entry->isBlock = true;
            body(*entry, ']');
            hold(node.depth, entry->depth);
            node.items.push_back(std::move(entry));
            open.reset();
        } else if (isSymbol(ahead, '{') && open) {
            next();
            open->isBlock = true;
            body(*open, '}');
            hold(node.depth, open->depth);
            open.reset();
        } else if (isItem(node, ahead)) {
            item(node, next(), open);
        } else {
            values(node, open);
        }
    }
}

// Whether a reserved word is a keyword here, and no value.
bool Parser::isItem(const Node& node, const Lexeme& token) {
    if (token.kind != TokenKind::kWord) return false;
    switch (m_names.use(token.name)) {
        case WordUse::kStatement:
            return true;
        case WordUse::kNumberFunction: {
            // Fractals take sqr, exp, ... by their names.
            return node.kind == "julia_fractal" && !isBehind('(');
        }
        case WordUse::kColourComponent:
            // Of pictures filter and transmit are options.
            return node.kind == "image_map" || wordOf(token) == "gray";
        default:
            return false;
    }
}

void Parser::item(Node& node, const Lexeme& token, std::shared_ptr<Node>& open) {
    const auto added = begunNode(token);
    node.items.push_back(added);
    open.reset();
    if (added->kind == "function") {
        while (beginsNumbers(peek()) && !isSymbol(peek(), '(')) {
            added->arguments.emplace_back(expression());
            takeSymbol(',');
        }
        added->arguments.emplace_back(functionValue());
        hold(added->depth, depthOf(added->arguments.back()));
        hold(node.depth, added->depth);
        return;
    }
    if (isSymbol(peek(), '{')) {
        next();
        added->isBlock = true;
        body(*added, '}');
        hold(node.depth, added->depth);
        return;
    }
    if (mostArguments(added->kind) > 0) open = added;
}

// A value, or many of a long list in < >.
void Parser::values(Node& node, std::shared_ptr<Node>& open) {
    Node& to = open && open->arguments.size() < mostArguments(open->kind) ? *open : node;
    const Lexeme& ahead = peek();
    if (isSymbol(ahead, '<')) {
        next();
        const std::vector<double> list = literal();
        if (list.size() > 5 || list.size() < 2) {
            for (const double value : list) to.arguments.emplace_back(Numbers::of(value));
            return;
        }
        to.arguments.emplace_back(expressionFrom(Numbers::vectorOf(list)));
        return;
    }
    if (ahead.kind == TokenKind::kName || beginsNumbers(ahead) || beginsText(ahead)) {
        to.arguments.push_back(rvalue());
        hold(to.depth, depthOf(to.arguments.back()));
        if (&to != &node) hold(node.depth, to.depth);
        return;
    }
    expected(next(), fmt::format("something that {} may have, or its end", node.kind));
}

void Parser::hold(std::uint32_t& depth, std::uint32_t held) {
    if (held >= kMostDepth) fail(fmt::format("values deeper than {} in each other", kMostDepth));
    depth = std::max(depth, held + 1);
}

}  // namespace pm::host::pov
