// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>

namespace pm::host {

// What light a code value x stands for: (a x + b)^g + e from x = d on, c x + f below; the numbers
// g a b c d e f, as in the parametric curve of type 4 of ICC.1:2010, 10.16.
using TransferCurve = std::array<double, 7>;

// IEC 61966-2-1.
inline constexpr TransferCurve kSrgbCurve{2.4, 1 / 1.055, 0.055 / 1.055, 1 / 12.92, 0.04045, 0, 0};

// x^exponent; what is below 0 counts as 0.
inline constexpr TransferCurve powerCurve(double exponent) {
    return {exponent, 1, 0, 0, 0, 0, 0};
}

// The light of a code value; codes outside [0,1] go on by the same formula. 0 where that has none.
double lightOf(const TransferCurve& curve, double code);

// Nowhere in [0,1] farther apart than what a table of 8-bit codes rounds to.
bool areAlike(const TransferCurve& a, const TransferCurve& b);

}  // namespace pm::host
