// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/shapes/close_spheres.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace pm {

namespace {

// Of what a point's coordinates may be; docs/stability.md: nested shells are right from 1e-6 of
// their radius on, and wrong at 1e-7.
constexpr double kClose = 6e-7;

double reachOf(const GlassSphere& sphere) {
    return maxAbsComponent(sphere.centre) + sphere.radius;
}

}  // namespace

std::size_t countCloseSpheres(std::vector<GlassSphere> spheres) {
    std::ranges::sort(spheres, {}, [](const GlassSphere& s) {
        return std::tuple(s.centre.x, s.centre.y, s.centre.z, s.radius);
    });
    std::size_t count = 0;
    for (std::size_t i = 1; i < spheres.size(); ++i) {
        const GlassSphere &a = spheres[i - 1], &b = spheres[i];
        const double close = kClose * reachOf(b), gap = b.radius - a.radius;
        if (maxAbsComponent(b.centre - a.centre) == 0 && gap > 0 && gap < close) ++count;
    }
    return count;
}

}  // namespace pm
