// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cmath>
#include <numbers>

#include "integrator/sampling/pinned_math.h"

// What part of the frame a pixel shows: the density that the places of its samples are drawn from.
// So each of them counts for as much as another, and no pixel needs a neighbour's. [1] Ernst,
// Stamminger & Greiner, "Filter Importance Sampling", IEEE Symposium on Interactive Ray Tracing
// 2006. [2] Wichura, "Algorithm AS 241: The Percentage Points of the Normal Distribution", Applied
// Statistics 37(3), 1988.
namespace pm {

enum class PixelFilter {
    kBox,       // even over the pixel
    kGaussian,  // along x as along y normal around the pixel's centre, cut off at kGaussianRadius
};

// As in PBRT, fourth edition, whose density is 0 at the cut; here it is 1.1 % of the greatest.
inline constexpr double kGaussianSigma = 0.5;   // pixels
inline constexpr double kGaussianRadius = 1.5;  // pixels
// Share of a normal variable beyond 3 standard deviations, on one side.
inline constexpr double kBeyondCut = 0.0013498980316300946;
static_assert(kGaussianRadius == 3 * kGaussianSigma);

// The number that a standard normal variable is below with probability 1/2 + q, q within +-0.4999;
// relative error below 1e-6, of sign and symmetry none [2, PPND7].
inline double standardNormalQuantile(double q) {
    if (std::abs(q) <= 0.425) {
        const double r = 0.180625 - q * q;
        return q * (((59.109374720 * r + 159.29113202) * r + 50.434271938) * r + 3.3871327179) /
               (((67.187563600 * r + 78.757757664) * r + 17.895169469) * r + 1.0);
    }
    const double tail = 0.5 - std::abs(q);
    const double r = std::sqrt(-std::numbers::ln2 * pinnedLog2(tail)) - 1.6;
    const double z = (((0.17023821103 * r + 1.3067284816) * r + 2.7568153900) * r + 1.4234372777) /
                     ((0.12021132975 * r + 0.73700164250) * r + 1.0);
    return std::copysign(z, q);
}

// Where a sample lies along x or y, pixels from the pixel's left or top edge, by a random number u
// in [0, 1). It rises with u: evenly spread numbers give places as evenly spread over the filter.
inline double placeInPixel(PixelFilter filter, float u) {
    const auto uniform = static_cast<double>(u);
    if (filter == PixelFilter::kBox) return uniform;
    return 0.5 +
           kGaussianSigma * standardNormalQuantile((uniform - 0.5) * (1.0 - 2.0 * kBeyondCut));
}

// Density of that place, over the pixel's width.
inline double densityInPixel(PixelFilter filter, double place) {
    if (filter == PixelFilter::kBox) return place >= 0 && place < 1 ? 1.0 : 0.0;
    const double z = (place - 0.5) / kGaussianSigma;
    if (!(std::abs(z) <= kGaussianRadius / kGaussianSigma)) return 0.0;
    constexpr double kOverRootTwoPi = 0.3989422804014327;
    return kOverRootTwoPi / kGaussianSigma / (1.0 - 2.0 * kBeyondCut) *
           pinnedExp2(-0.5 * std::numbers::log2e * z * z);
}

}  // namespace pm
