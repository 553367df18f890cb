// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// The language's own functions of numbers; POV-Ray's manual, 3.3.1.5.4 and 3.3.1.6.5.
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <numbers>

#include "host_shim/formats/pov/evaluation/parser.h"
#include "host_shim/formats/pov/values/transform_of.h"
#include "host_shim/values/host_error.h"

namespace pm::host::pov {
namespace {

std::array<double, 3> three(const Numbers& v) {
    return {v.at[0], v.at[1], v.at[2]};
}
Numbers vectorOf(const std::array<double, 3>& v) {
    return Numbers::vector(v[0], v[1], v[2]);
}
double dot(const Numbers& a, const Numbers& b) {
    return a.at[0] * b.at[0] + a.at[1] * b.at[1] + a.at[2] * b.at[2];
}
Numbers cross(const Numbers& a, const Numbers& b) {
    return Numbers::vector(a.at[1] * b.at[2] - a.at[2] * b.at[1],
                           a.at[2] * b.at[0] - a.at[0] * b.at[2],
                           a.at[0] * b.at[1] - a.at[1] * b.at[0]);
}

// Rodrigues' formula, in the left-handed sense as rotation().
Numbers aboutAxis(const Numbers& v, const Numbers& axis, double degrees) {
    const double length = std::sqrt(dot(axis, axis));
    if (length == 0) return v;
    const Numbers unit = combined(axis, '/', Numbers::of(length));
    const double angle = degrees * std::numbers::pi / 180;
    const Numbers along = combined(unit, '*', Numbers::of(dot(unit, v) * (1 - std::cos(angle))));
    const Numbers turned = combined(combined(v, '*', Numbers::of(std::cos(angle))), '+',
                                    combined(cross(unit, v), '*', Numbers::of(std::sin(angle))));
    return combined(turned, '+', along);
}

}  // namespace

Numbers Parser::numberFunction(const Lexeme& token) {
    const std::string word = wordOf(token);
    const Deeper deeper(*this);
    expectSymbol('(');
    Numbers value;
    std::size_t least = 0, most = 0;
    if (isFunctionBuiltIn(word, least, most) && word != "sum" && word != "prod") {
        std::vector<double> arguments;
        do arguments.push_back(number());
        while (takeSymbol(','));
        if (arguments.size() < least || arguments.size() > most)
            fail(fmt::format(
                "{} of {} arguments; {} are wanted", word, arguments.size(),
                least == most ? std::to_string(least) : fmt::format("{} to {}", least, most)));
        value = Numbers::of(builtIn(word, arguments));
    } else if (word == "rand" || word == "seed") {
        value = randomNumber(word == "seed");
    } else if (word[0] == 'v' && word != "val") {
        value = vectorFunction(word);
    } else {
        value = textAsNumber(word);
    }
    expectSymbol(')');
    return value;
}

Numbers Parser::vectorFunction(const std::string& word) {
    if (word == "vturbulence") fail("vturbulence waits for patterns");
    const Numbers a = vector(3);
    if (word == "vlength") return Numbers::of(std::sqrt(dot(a, a)));
    if (word == "vnormalize") {
        const double length = std::sqrt(dot(a, a));
        if (length == 0) fail("vnormalize of a vector of length 0");
        return combined(a, '/', Numbers::of(length));
    }
    expectSymbol(',');
    const Numbers b = vector(3);
    if (word == "vdot") return Numbers::of(dot(a, b));
    if (word == "vcross") return cross(a, b);
    if (word == "vrotate") return vectorOf(transformed(rotation(three(b)), three(a)));
    expectSymbol(',');
    return aboutAxis(a, b, number());
}

// Functions of texts, files, arrays, identifiers and objects.
Numbers Parser::textAsNumber(const std::string& word) {
    if (word == "asc") {
        const std::string of = text();
        return Numbers::of(of.empty() ? 0 : static_cast<unsigned char>(of[0]));
    }
    if (word == "strlen") return Numbers::of(static_cast<double>(text().size()));
    if (word == "file_exists") return Numbers::of(m_around.find(text(true)) ? 1 : 0);
    if (word == "strcmp") {
        const std::string first = text();
        expectSymbol(',');
        return Numbers::of(first.compare(text()));
    }
    if (word == "val") {
        const std::string of = text();
        const auto source = cutIntoTokens(of, "val", m_names, 4);
        double sign = 1;
        std::size_t at = 0;
        if (source->tokens[0].kind == TokenKind::kSymbol)
            sign = source->tokens[at++].symbol == '-' ? -1 : 1;
        if (source->tokens[at].kind != TokenKind::kNumber) return Numbers::of(0);
        return Numbers::of(sign * source->tokens[at].number);
    }
    if (word == "defined") {
        const Lexeme name = raw();
        const Value* const value =
            name.kind == TokenKind::kName ? m_symbols.find(name.name) : nullptr;
        return Numbers::of(value != nullptr && value->index() != 0);
    }
    if (word == "dimensions" || word == "dimension_size") {
        const Lexeme name = next();
        Value* const value = name.kind == TokenKind::kName ? resolved(name) : nullptr;
        const auto* const array = heldIn<std::shared_ptr<Array>>(value);
        if (array == nullptr) expected(name, "an array");
        const auto sizes = (*array)->sizes;
        if (word == "dimensions") return Numbers::of(static_cast<double>(sizes.size()));
        expectSymbol(',');
        const double which = number();
        if (!(which >= 1 && which < static_cast<double>(sizes.size()) + 1))
            fail(fmt::format("dimension {} of an array of {}", which, sizes.size()));
        return Numbers::of(sizes[static_cast<std::size_t>(which) - 1]);
    }
    // trace, inside, min_extent, max_extent
    const Lexeme name = next();
    const Value* const value = name.kind == TokenKind::kName ? resolved(name) : nullptr;
    const auto* const node = heldIn<NodePtr>(value);
    if (node == nullptr) expected(name, "an object");
    fail(fmt::format("{} of {}: waits for shapes", word, kindOf(*value)));
}

// x' = 1812433253 x + 12345 modulo 2^32, and of it x' / (2^32 - 1); as POV-Ray's output shows.
Numbers Parser::randomNumber(bool isSeed) {
    const double given = number();
    constexpr std::size_t kMostStreams = 1u << 20;
    if (isSeed) {
        if (m_random.size() >= kMostStreams) fail("more than 2^20 streams of random numbers");
        m_random.push_back(static_cast<std::uint32_t>(static_cast<std::int64_t>(given)));
        return Numbers::of(static_cast<double>(m_random.size() - 1));
    }
    if (!(given >= 0 && given < static_cast<double>(m_random.size())))
        fail(fmt::format("rand of stream {}; seed() has made {} of them", given, m_random.size()));
    std::uint32_t& state = m_random[static_cast<std::size_t>(given)];
    state = 1812433253u * state + 12345u;
    return Numbers::of(state / 4294967295.0);
}

Numbers Parser::callFunction(const Function& function) {
    expectSymbol('(');
    std::vector<double> arguments;
    if (!takeSymbol(')')) {
        do {
            const Numbers value = expression();
            // A vector stands for its components.
            for (std::size_t i = 0; i < (value.isFloat() ? 1u : 3u); ++i)
                arguments.push_back(value.at[i]);
        } while (takeSymbol(','));
        expectSymbol(')');
    }
    if (!function.takes(arguments.size()))
        fail(fmt::format("function {} of {} arguments; {} are wanted", function.name,
                         arguments.size(), function.arity()));
    try {
        return evaluated(function, arguments);
    } catch (const HostError& error) {
        fail(error.what());
    }
}

Numbers Parser::callSpline(const Spline& spline) {
    expectSymbol('(');
    const double parameter = number();
    SplineKind kind = spline.kind;
    if (takeSymbol(',')) {
        const Lexeme word = next();
        if (word.kind != TokenKind::kWord || !splineKindOf(wordOf(word), kind))
            expected(word, "linear_spline, quadratic_spline, cubic_spline or natural_spline");
    }
    expectSymbol(')');
    if (spline.points.empty()) fail("a spline without points");
    return spline.at(parameter, kind);
}

}  // namespace pm::host::pov
