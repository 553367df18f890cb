// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>
#include <string>

#include "host_shim/pictures/picture.h"

namespace pm::host {

// Exposures are in stops: of display pictures, values are multiplied by 2^stops before the view.
inline constexpr double kMostExposureStops = 20.0;  // and as many down

// An exposure, and where it comes from.
struct Exposure {
    enum class From { kDefault, kGiven, kMeasured };
    double stops{};  // within +-kMostExposureStops
    From from{From::kDefault};
};

// "2.41 (auto)", "-1", "0": as files and people are told.
std::string exposureText(const Exposure& exposure);

// What a camera's automatic exposure would take for a scene-linear picture (R, G, B, A and
// emission.R ...): its log-average luminance becomes a middle grey of 0.18, unless that made more
// than one metered pixel in fifty brighter than 2. Metered is what is covered, shows no lamp and,
// where the picture has albedo.R ..., reflects 1e-4 or more (any, where nothing does); or, where
// that is less than a tenth of this and of the lamps, both. Rounded to 1/100, so that the value as
// it is printed gives the same picture. 0 where nothing metered has light. luminance: weights of R,
// G and B.
double measuredExposureStops(const Picture& picture, const std::array<double, 3>& luminance);

// How much of what is covered and shows no lamp, nor reflects nothing, has light that some exposure
// can show, in [0,1]; 1 where nothing is covered but by lamps.
double litShare(const Picture& picture, const std::array<double, 3>& luminance);

// How much of what is covered and shows no lamp, nor reflects nothing, stays nearly black (below
// code 8 of 255 as sRGB) at the exposure that is measured, in [0,1]; 0 where nothing is covered but
// by lamps.
double darkShare(const Picture& picture, const std::array<double, 3>& luminance);

// How much of what is covered and shows no lamp reflects nothing at all, as albedo.R ... say, in
// [0,1].
double blackShare(const Picture& picture, const std::array<double, 3>& luminance);

}  // namespace pm::host
