// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "tests/bench/plot/ratios.h"

#include <fmt/format.h>

#include <cmath>

namespace pm::bench {

Interval intervalOf(const std::vector<double>& ratios) {
    const auto n = static_cast<double>(ratios.size());
    double mean = 0, squares = 0;
    for (const double ratio : ratios) mean += std::log(ratio) / n;
    for (const double ratio : ratios) squares += std::pow(std::log(ratio) - mean, 2);
    if (n < 2) return {std::exp(mean), std::exp(mean), std::exp(mean)};
    // Student's quantile: exact for the few turns of a quick run, else to second order in 1 / f.
    static constexpr double kFew[] = {12.7062, 4.3027, 3.1824, 2.7764};
    const double z = 1.959964, f = n - 1;
    const double t = n < 6 ? kFew[ratios.size() - 2]
                           : z + (std::pow(z, 3) + z) / (4 * f) +
                                 (5 * std::pow(z, 5) + 16 * std::pow(z, 3) + 3 * z) / (96 * f * f);
    const double reach = t * std::sqrt(squares / f / n);
    return {std::exp(mean), std::exp(mean - reach), std::exp(mean + reach)};
}

std::string showRatios(const std::vector<double>& ratios) {
    const Interval interval = intervalOf(ratios);
    if (ratios.size() < 2) return fmt::format("{:.4f}", interval.mean);
    return fmt::format("{:.4f} ({:.4f} to {:.4f})", interval.mean, interval.low, interval.high);
}

}  // namespace pm::bench
