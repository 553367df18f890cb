// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/pictures/error_words.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace pm::host {
namespace {

struct Row {
    double mostCodes;
    const char* words;
    bool isOfParts;  // whether it is told where it is true of the dark or bright parts alone
};

// docs/first_look.md shows it to users.
constexpr std::array<Row, 5> kTable{{{kCleanCodes, "clean at 8 bits", false},
                                     {3, "noise barely visible", false},
                                     {8, "visible noise", true},
                                     {24, "noisy", true},
                                     {std::numeric_limits<double>::infinity(), "a draft", false}}};
constexpr const Row& kBarelyVisible = kTable[1];

const Row& rowOf(double codes) {
    // False for NaN, which is a draft.
    const auto* found =
        std::ranges::find_if(kTable, [codes](const Row& row) { return codes <= row.mostCodes; });
    return found == kTable.end() ? kTable.back() : *found;
}

// Codes by the root of relMSE, of pictures at neutral exposure.
constexpr double kCodesByRoot = 300;

}  // namespace

std::string errorWords(const SeenError& error) {
    const Row& row = rowOf(error.codes);
    if (error.isLowerBound && row.mostCodes <= kCleanCodes) return kBarelyVisible.words;
    if (!row.isOfParts) return row.words;
    if (error.brightCodes <= kBarelyVisible.mostCodes)
        return fmt::format("{} in dark parts", row.words);
    if (error.darkCodes <= kBarelyVisible.mostCodes)
        return fmt::format("{} in bright parts", row.words);
    return row.words;
}

std::string errorWords(double relMse) {
    const double codes = kCodesByRoot * std::sqrt(relMse);
    return errorWords(SeenError{codes, codes, codes, true});
}

std::string describe(const SeenError& error) {
    constexpr double kLeast = 0.1;  // finer than that nobody asks
    return fmt::format("{}, 95 % of the pixels within {:.2g} codes of 255", errorWords(error),
                       std::max(error.codes, kLeast));
}

}  // namespace pm::host
