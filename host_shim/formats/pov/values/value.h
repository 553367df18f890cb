// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "host_shim/formats/pov/lexer/place.h"
#include "host_shim/formats/pov/values/numbers.h"

namespace pm::host::pov {

struct Array;
struct Function;
struct Macro;
struct Node;
struct Spline;
class TextFile;

// What an identifier may stand for. Nothing: an element of an array that was not declared.
using Value = std::variant<std::monostate, Numbers, std::string, std::shared_ptr<Array>,
                           std::shared_ptr<const Spline>, std::shared_ptr<const Function>,
                           std::shared_ptr<const Node>, std::shared_ptr<const Macro>,
                           std::shared_ptr<TextFile>>;

// The T that a value is; nullptr where there is no value, or one of another type.
template <typename T, typename Of>
auto* heldIn(Of* value) {
    return value == nullptr ? nullptr : std::get_if<T>(value);
}

// "a float", "a vector of 3", "an array", "a sphere" ... for messages.
std::string kindOf(const Value& value);

// How deep a value holds others: 0 of numbers, texts and files.
std::uint32_t depthOf(const Value& value);
inline constexpr std::uint32_t kMostDepth = 1000;

// Of one or more dimensions; elements row by row.
struct Array {
    std::uint32_t depth{1};  // more than that of each element
    std::vector<std::uint32_t> sizes;
    std::vector<Value> elements;
};

// A statement of the scene language as it was evaluated: an object, a texture, a transform, a
// keyword with its arguments. Of `sphere { <0, 1, 0>, 2 scale 3 }` the kind is "sphere", the
// arguments are the vector and the float, and the items are one node "scale" with one argument.
// An identifier in it stands as the node that it was declared as, shared.
struct Node {
    std::string_view kind;  // a reserved word, "[" for an entry of a map
    Place place;
    bool isBlock{};          // with { } or [ ]
    std::uint32_t depth{1};  // more than that of each argument and item
    std::vector<Value> arguments;
    std::vector<std::shared_ptr<const Node>> items;

    // The last item of that kind, which is the one that counts; nullptr where there is none.
    const Node* find(std::string_view itemKind) const;
    // Argument i as numbers; nullptr where it is none.
    const Numbers* numbers(std::size_t i) const;
    const std::string* text(std::size_t i) const;
};

// As the language would have it, on one line; numbers with as many digits as they need. What is
// alike is printed alike.
std::string printed(const Node& node);
std::string printed(const Value& value);
std::string printed(const Numbers& numbers);

}  // namespace pm::host::pov
