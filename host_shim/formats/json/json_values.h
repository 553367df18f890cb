// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <concepts>
#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <utility>

namespace pm::host {

// A whole number that an object has; JSON's own reading of it would cut one that is too large or
// has a fraction. Errors: std::exception for one that is not there or not of the type's range.
template <std::integral Integer>
Integer wholeNumber(const nlohmann::ordered_json& object, const char* key) {
    const nlohmann::ordered_json& value = object.at(key);
    const bool isIn =
        value.is_number_unsigned()
            ? std::in_range<Integer>(value.get<std::uint64_t>())
            : value.is_number_integer() && std::in_range<Integer>(value.get<std::int64_t>());
    if (!isIn)
        throw std::runtime_error("'" + std::string(key) + "' is no whole number from " +
                                 std::to_string(std::numeric_limits<Integer>::min()) + " to " +
                                 std::to_string(std::numeric_limits<Integer>::max()));
    return static_cast<Integer>(value.is_number_unsigned()
                                    ? value.get<std::uint64_t>()
                                    : static_cast<std::uint64_t>(value.get<std::int64_t>()));
}

}  // namespace pm::host
