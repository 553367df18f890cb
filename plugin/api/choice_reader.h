// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <fmt/format.h>

#include <array>
#include <cstddef>
#include <cstdint>

#include "plugin/values/call_error.h"

namespace pm::plugin {

// What a number in a caller's struct stands for; choices: in the order of the interface's
// constants, which count from 0. Errors: ARGUMENT for another number, by what the member and the
// constants are called.
template <typename Choice, std::size_t Count>
Choice readChoice(std::int32_t number, const std::array<Choice, Count>& choices, const char* member,
                  const char* constants) {
    if (number < 0 || static_cast<std::size_t>(number) >= Count)
        throw argumentError(
            fmt::format("{} is {}; it must be 0 to {} ({})", member, number, Count - 1, constants));
    return choices[static_cast<std::size_t>(number)];
}

}  // namespace pm::plugin
