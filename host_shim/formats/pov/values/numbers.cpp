// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/formats/pov/values/numbers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace pm::host::pov {
namespace {

bool isEqual(double a, double b) {
    return std::abs(a - b) < kEpsilon;
}
bool isTrue(double a) {
    return std::abs(a) > kEpsilon;
}

double combined(double a, char op, double b) {
    switch (op) {
        case '+':
            return a + b;
        case '-':
            return a - b;
        case '*':
            return a * b;
        case '/':
            return b == 0 ? std::numeric_limits<double>::max() : a / b;
        case '<':
            return a < b && !isEqual(a, b);
        case '>':
            return a > b && !isEqual(a, b);
        case '=':
            return isEqual(a, b);
        case 'l':
            return a < b || isEqual(a, b);
        case 'g':
            return a > b || isEqual(a, b);
        case 'n':
            return !isEqual(a, b);
        case '&':
            return isTrue(a) && isTrue(b);
        case '|':
            return isTrue(a) || isTrue(b);
    }
    return std::numeric_limits<double>::quiet_NaN();
}

}  // namespace

std::size_t componentOf(std::string_view word) {
    constexpr std::array<std::pair<std::string_view, std::size_t>, 12> kComponents{{
        {"x", 0},
        {"u", 0},
        {"red", 0},
        {"y", 1},
        {"v", 1},
        {"green", 1},
        {"z", 2},
        {"blue", 2},
        {"t", 3},
        {"filter", 3},
        {"transmit", 4},
        {"gray", 5},
    }};
    const auto found = std::ranges::find(kComponents, word, [](const auto& c) { return c.first; });
    return found == kComponents.end() ? 6 : found->second;
}

double gray(const Numbers& colour) {
    return 0.297 * colour.at[0] + 0.589 * colour.at[1] + 0.114 * colour.at[2];
}

Numbers Numbers::vectorOf(std::span<const double> components) {
    Numbers vector;
    vector.size = static_cast<std::uint8_t>(components.size());
    std::ranges::copy(components, vector.at.begin());
    return vector;
}

Numbers Numbers::promoted(std::size_t components) const {
    Numbers to = *this;
    if (size == 1) to.at.fill(at[0]);
    for (std::size_t i = components; i < to.at.size(); ++i) to.at[i] = 0;
    to.size = static_cast<std::uint8_t>(components);
    if (components < 5) to.isColour = false;
    return to;
}

Numbers combined(const Numbers& a, char op, const Numbers& b) {
    const std::size_t size = std::max(a.size, b.size);
    const Numbers left = a.promoted(size), right = b.promoted(size);
    Numbers result;
    result.size = static_cast<std::uint8_t>(size);
    result.isColour = a.isColour || b.isColour;
    for (std::size_t i = 0; i < size; ++i) result.at[i] = combined(left.at[i], op, right.at[i]);
    return result;
}

}  // namespace pm::host::pov
