// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/formats/mtl/coat_albedo.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace pm::host {
namespace {

// Integrals over all directions of arrival and departure, for roughness 0, .1 ... 1 (the test does
// them): the coat's is about f0 * ofCoat + (1 - f0) * atGrazing, as Schlick's Fresnel is linear in
// f0.
struct Means {
    double ofCoat, atGrazing, ofLobe;
};
constexpr std::array<Means, 11> kMeans{{{1.078, 0.049, 0.667},
                                        {1.078, 0.048, 0.667},
                                        {1.071, 0.045, 0.667},
                                        {1.050, 0.038, 0.667},
                                        {1.006, 0.029, 0.670},
                                        {0.938, 0.022, 0.677},
                                        {0.847, 0.015, 0.692},
                                        {0.741, 0.011, 0.718},
                                        {0.629, 0.008, 0.752},
                                        {0.521, 0.005, 0.793},
                                        {0.423, 0.004, 0.833}}};

double interpolated(double roughness, double Means::*part) {
    const double at = std::clamp(roughness, 0.0, 1.0) * (kMeans.size() - 1);
    const auto below = std::min(static_cast<std::size_t>(at), kMeans.size() - 2);
    const double share = at - static_cast<double>(below);
    return (1 - share) * (kMeans[below].*part) + share * (kMeans[below + 1].*part);
}

}  // namespace

// GGX of alpha has the half vectors of Blinn's exponent 2 / alpha^2 - 2 near its peak; the mirror
// direction turns by twice the angle of the half vector, which takes a quarter of the exponent.
double exponentOfRoughness(double roughness) {
    constexpr double kSmoothest = 2e-3;  // alpha; below, lobes are narrower than a pixel
    const double alpha = std::max(roughness * roughness, kSmoothest);
    return (2 / (alpha * alpha) - 2) / 4;
}

double meanOfCoat(double f0, double roughness) {
    return f0 * interpolated(roughness, &Means::ofCoat) +
           (1 - f0) * interpolated(roughness, &Means::atGrazing);
}

double meanOfLobe(double roughness) {
    return interpolated(roughness, &Means::ofLobe);
}

}  // namespace pm::host
