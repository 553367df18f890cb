// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstddef>
#include <string_view>

namespace pm::host {

// How many letters a word may be off to be a slip of the hand for another.
inline constexpr std::size_t kMostLettersApart = 2;

// Letters to add, drop or change to make one word of the other (Levenshtein 1966).
std::size_t lettersApart(std::string_view a, std::string_view b);

}  // namespace pm::host
