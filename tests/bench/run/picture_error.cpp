// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "tests/bench/run/picture_error.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace pm::bench {

double relativeError(std::span<const double> a, std::span<const double> b,
                     std::span<const double> reference, double dropped) {
    std::vector<double> errors(reference.size() / 3);
    for (std::size_t i = 0; i < reference.size(); ++i) {
        const double r = reference[i];
        errors[i / 3] += (a[i] - r) * (b[i] - r) / (r * r + 0.01) / 3;
    }
    std::sort(errors.begin(), errors.end(),
              [](double x, double y) { return std::abs(x) < std::abs(y); });
    // A NaN in the picture must show, wherever it was sorted to.
    const auto out =
        static_cast<std::size_t>(std::ceil(dropped * static_cast<double>(errors.size())));
    double sum = 0;
    for (std::size_t i = 0; i < errors.size(); ++i)
        if (i < errors.size() - out || std::isnan(errors[i])) sum += errors[i];
    return sum / static_cast<double>(errors.size() - out);
}

double Yardstick::commonDifference(std::span<const double> t1, std::span<const double> a1,
                                   std::span<const double> t2, std::span<const double> a2) const {
    std::vector<double> first, second;
    for (std::size_t i = 0; i < reference.size(); ++i) {
        first.push_back(t1[i] - a1[i] + reference[i]);
        second.push_back(t2[i] - a2[i] + reference[i]);
    }
    return commonError(first, second);
}

double Yardstick::meanOver(std::span<const double> picture) const {
    double ours = 0, theirs = 0;
    for (std::size_t i = 0; i + 2 < reference.size(); i += 3) {
        const auto brightestOf = [i](std::span<const double> rgb) {
            return std::max({rgb[i], rgb[i + 1], rgb[i + 2]});
        };
        if (brightest > 0 && std::max(brightestOf(picture), brightestOf(reference)) > brightest)
            continue;
        for (std::size_t c = i; c < i + 3; ++c) {
            ours += picture[c];
            theirs += reference[c];
        }
    }
    return ours / theirs;
}

}  // namespace pm::bench
