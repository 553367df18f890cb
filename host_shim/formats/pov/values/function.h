// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "host_shim/formats/pov/values/numbers.h"
#include "host_shim/formats/pov/values/value.h"

namespace pm::host::pov {

// A term of the expression of a function. Of a call `text` names what is called, and `function` is
// it where the scene declared it.
struct FunctionTerm {
    enum class Kind : std::uint8_t {
        kNumber,
        kParameter,  // index
        kOperation,  // text: one of + - * / < > = l g n & |, two terms; or "-", "!", one term
        kBuiltIn,    // text: sin, max, ...; sum and prod: index of their variable, begin, end, term
        kCall,       // of another function
        kComponent,  // text: x, red, ... of a call's vector
    };

    Kind kind{Kind::kNumber};
    double number{};
    std::uint32_t index{};
    std::string text;
    std::shared_ptr<const Function> function;
    std::vector<FunctionTerm> terms;
};

// A function of the scene: an expression of its parameters, one of the language's own by number,
// or a pattern, pigment, transform or spline that is asked at a place.
//
// Its text form, which printed() gives, is `function (x, y, z) { expression }` with parentheses
// around each operation; calls of declared functions stand as `(function (...) {...})(a, b)`.
struct Function {
    std::vector<std::string> parameters;
    FunctionTerm expression;
    int internal{-1};                  // functions.inc: internal(N)
    std::shared_ptr<const Node> node;  // pattern, pigment or transform
    std::shared_ptr<const Spline> spline;
    std::string name;        // that it was declared by, for messages
    std::uint32_t depth{1};  // more than that of what it calls or asks

    bool isExpression() const { return internal < 0 && !node && !spline; }
    // How many arguments it takes: of one by number any.
    bool takes(std::size_t arguments) const { return internal >= 0 || arguments == arity(); }
    std::size_t arity() const { return node ? 3 : spline ? 1 : parameters.size(); }
};

std::string printed(const Function& function);

// Whether the text is a built-in function of floats that functions may use, and how many arguments
// it takes: least to most.
bool isFunctionBuiltIn(std::string_view text, std::size_t& least, std::size_t& most);
// One of those.
double builtIn(std::string_view text, std::span<const double> arguments);

// Floats have one component. Errors: kBadInput for what is not computed here (patterns and
// pigments, which wait for looks), and for calls deeper than 256.
Numbers evaluated(const Function& function, std::span<const double> arguments);

}  // namespace pm::host::pov
