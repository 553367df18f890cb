// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "host_shim/check/region_spread.h"
#include "host_shim/pictures/picture.h"

namespace pm::host {

// Renders of one seed share their noise, so what they differ by is what has changed. Only rounding
// is left, as of another compiler: it is measured by twins, renders of the reference's seed whose
// vertices are moved by 1e-7 of their coordinates (--twin).

inline constexpr std::int32_t kPairSide = 8;       // of its regions, pixels
inline constexpr double kPairLimit = 10;           // standard deviations
inline constexpr std::int32_t kTwins = 8;          // renders
inline constexpr double kPairedCorrelation = 0.5;  // above it two renders share their noise

// By how much a region of a paired render may be off, as RegionGrid::means has them.
struct PairSpread {
    std::vector<double> mean;      // of the picture that is kept
    std::vector<double> variance;  // of another one's mean against it
};

// Of a region and colour with the mean R, (n v + n r R^2) / (2 n) + (1e-6 R)^2: v is the mean
// squared difference of the n twins from R, r the median of v / R^2 over all. kept: the means of
// the reference; twins: those of each twin. Errors: kInternal without twins.
PairSpread pairSpreadOf(const std::vector<double>& kept,
                        const std::vector<std::vector<double>>& twins);

// The region that is off by most standard deviations.
RegionFinding furthestOfPair(const PixelRect& window, const PairSpread& spread,
                             const std::vector<double>& means);

// The relative change of a region that is beyond the limit, of those that are not black the median;
// 0 when all are.
double seenByPairs(const PairSpread& spread);

// What renders of other seeds make of each pixel: channels mean.R, mean.G, mean.B, deviation.R ...,
// the standard deviation of one render. pictures: of one window, at least two.
Picture pixelNoiseOf(const std::vector<const Picture*>& pictures);

// How the noise of two pictures correlates, in [-1, 1]; nothing where one has none or `noise`
// doesn't fit. The noise of a pixel is (p - m) / max(s, .05 m + 1e-6 u), in [-3, 3], less its mean
// over each 8 x 8 pixels and colour, so that what is brighter as a whole is no noise; u is 2 to the
// power of minus the error scale of `a`.
std::optional<double> noiseCorrelation(const Picture& noise, const Picture& a, const Picture& b);

}  // namespace pm::host
