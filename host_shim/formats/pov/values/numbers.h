// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace pm::host::pov {

// A float (one component), a vector (2 to 5) or a colour (5: red, green, blue, filter, transmit).
struct Numbers {
    std::array<double, 5> at{};
    std::uint8_t size{1};
    bool isColour{};

    static Numbers of(double value) { return {{value}, 1, false}; }
    static Numbers vector(double x, double y, double z) { return {{x, y, z}, 3, false}; }
    // Of 2 to 5 components.
    static Numbers vectorOf(std::span<const double> components);
    static Numbers colour(double red, double green, double blue, double filter, double transmit) {
        return {{red, green, blue, filter, transmit}, 5, true};
    }

    bool isFloat() const { return size == 1; }
    // A float fills all components, a shorter vector is filled with 0; a longer one is cut.
    Numbers promoted(std::size_t components) const;
    bool operator==(const Numbers&) const = default;
};

// Which of .x, .red and the like; 5: the gray of a colour; 6: none of them.
std::size_t componentOf(std::string_view word);

double gray(const Numbers& colour);

// What is nearer to 0 is false, and what is nearer to each other is equal.
inline constexpr double kEpsilon = 1e-10;

// By component, after the smaller was promoted. op: + - * /; what is divided by 0 is infinite (the
// caller warns); of a comparison (< > = l g n, see Symbol) or of & and |: 1 or 0.
Numbers combined(const Numbers& a, char op, const Numbers& b);

}  // namespace pm::host::pov
