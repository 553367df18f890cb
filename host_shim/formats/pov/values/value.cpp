// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/formats/pov/values/value.h"

#include <fmt/format.h>

#include <algorithm>

#include "host_shim/formats/pov/values/function.h"
#include "host_shim/formats/pov/values/spline.h"

namespace pm::host::pov {
namespace {

template <typename... Cases>
struct Overloaded : Cases... {
    using Cases::operator()...;
};
template <typename... Cases>
Overloaded(Cases...) -> Overloaded<Cases...>;

std::string withArticle(std::string_view kind) {
    const bool isVowel = !kind.empty() && std::string_view("aeiou").find(kind[0]) != kind.npos;
    return fmt::format("{} {}", isVowel ? "an" : "a", kind);
}

std::string printed(const Spline& spline) {
    std::string text = fmt::format("spline {{ {}", wordOf(spline.kind));
    for (const Spline::Point& point : spline.points)
        text += fmt::format(" {}, {}", point.parameter, printed(point.value));
    return text + " }";
}

std::string printed(const Array& array) {
    std::string text = "array";
    for (const std::uint32_t size : array.sizes) text += fmt::format("[{}]", size);
    text += " {";
    for (const Value& element : array.elements) text += ' ' + printed(element) + ',';
    if (text.back() == ',') text.pop_back();
    return text + " }";
}

}  // namespace

std::string kindOf(const Value& value) {
    return std::visit(
        Overloaded{
            [](std::monostate) -> std::string { return "nothing"; },
            [](const Numbers& numbers) -> std::string {
                if (numbers.isColour) return "a colour";
                return numbers.isFloat() ? "a float" : fmt::format("a vector of {}", numbers.size);
            },
            [](const std::string&) -> std::string { return "a string"; },
            [](const std::shared_ptr<Array>&) -> std::string { return "an array"; },
            [](const std::shared_ptr<const Spline>&) -> std::string { return "a spline"; },
            [](const std::shared_ptr<const Function>&) -> std::string { return "a function"; },
            [](const std::shared_ptr<const Node>& node) { return withArticle(node->kind); },
            [](const std::shared_ptr<const Macro>&) -> std::string { return "a macro"; },
            [](const std::shared_ptr<TextFile>&) -> std::string { return "a file"; },
        },
        value);
}

std::uint32_t depthOf(const Value& value) {
    return std::visit(
        Overloaded{
            [](const std::shared_ptr<Array>& array) { return array->depth; },
            [](const std::shared_ptr<const Function>& function) { return function->depth; },
            [](const std::shared_ptr<const Node>& node) { return node->depth; },
            [](const auto&) { return 0u; },
        },
        value);
}

const Node* Node::find(std::string_view itemKind) const {
    const auto found = std::find_if(items.rbegin(), items.rend(), [itemKind](const auto& item) {
        return item->kind == itemKind;
    });
    return found == items.rend() ? nullptr : found->get();
}

const Numbers* Node::numbers(std::size_t i) const {
    return i < arguments.size() ? std::get_if<Numbers>(&arguments[i]) : nullptr;
}

const std::string* Node::text(std::size_t i) const {
    return i < arguments.size() ? std::get_if<std::string>(&arguments[i]) : nullptr;
}

std::string printed(const Numbers& numbers) {
    if (numbers.isFloat()) return fmt::format("{}", numbers.at[0]);
    return fmt::format("{}<{}>", numbers.isColour ? "rgbft " : "",
                       fmt::join(numbers.at.begin(), numbers.at.begin() + numbers.size, ", "));
}

std::string printed(const Value& value) {
    return std::visit(
        Overloaded{
            [](std::monostate) -> std::string { return "nothing"; },
            [](const Numbers& numbers) { return printed(numbers); },
            [](const std::string& text) { return fmt::format("\"{}\"", text); },
            [](const std::shared_ptr<Array>& array) { return printed(*array); },
            [](const std::shared_ptr<const Spline>& spline) { return printed(*spline); },
            [](const std::shared_ptr<const Function>& function) { return printed(*function); },
            [](const std::shared_ptr<const Node>& node) { return printed(*node); },
            [](const std::shared_ptr<const Macro>&) -> std::string { return "macro"; },
            [](const std::shared_ptr<TextFile>&) -> std::string { return "file"; },
        },
        value);
}

std::string printed(const Node& node) {
    std::string inside;
    for (const Value& argument : node.arguments)
        inside += (inside.empty() ? "" : ", ") + printed(argument);
    for (const auto& item : node.items) inside += (inside.empty() ? "" : " ") + printed(*item);
    if (node.kind == "[") return fmt::format("[{}]", inside);
    if (!node.isBlock) return std::string(node.kind) + (inside.empty() ? "" : " ") + inside;
    return fmt::format("{} {{ {} }}", node.kind, inside);
}

}  // namespace pm::host::pov
