// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <span>
#include <vector>

namespace pm::bench {

// Mean over pixels and channels of (a - r)(b - r)/(r^2 + 0.01), without the share `dropped` of the
// pixels where it is largest. With a = b it is relMSE; with a and b that share no noise the noise
// cancels, and what stays is the energy of the error they have in common: bias, and the reference's
// own noise.
double relativeError(std::span<const double> a, std::span<const double> b,
                     std::span<const double> reference, double dropped);

// What pictures of one scene are held against. Pictures are RGB, row by row.
struct Yardstick {
    std::vector<double> reference;
    double dropped = 0;    // share of the worst pixels that is left out
    double ownNoise = 0;   // relMSE that the reference's noise alone makes, about
    double brightest = 0;  // pixels above are left out of meanOver; 0 = none are

    double relMse(std::span<const double> picture) const {
        return relativeError(picture, picture, reference, dropped);
    }
    // Of two pictures that share no noise.
    double commonError(std::span<const double> a, std::span<const double> b) const {
        return relativeError(a, b, reference, dropped);
    }
    // Energy of what the expectations of t and a differ by, from two independent pairs of pictures.
    double commonDifference(std::span<const double> t1, std::span<const double> a1,
                            std::span<const double> t2, std::span<const double> a2) const;
    // Sum over the reference's: the first sign of lost or doubled light.
    double meanOver(std::span<const double> picture) const;
};

}  // namespace pm::bench
