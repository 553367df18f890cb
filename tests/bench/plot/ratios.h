// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <string>
#include <vector>

namespace pm::bench {

struct Interval {
    double mean = 0, low = 0, high = 0;  // low = high = mean where nothing is known of the spread
};

// The geometric mean of ratios and its 95 % interval, of independent turns, by Student's
// distribution. ratios: > 0, at least one.
Interval intervalOf(const std::vector<double>& ratios);

// "1.0012 (0.9987 to 1.0036)"; one number alone has no brackets.
std::string showRatios(const std::vector<double>& ratios);

}  // namespace pm::bench
