// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/photons/emission/focus_balls.h"

#include <algorithm>
#include <cmath>

#include "integrator/photons/emission/aim_mixture.h"

namespace pm {

namespace {

// Casters less wide than so many times the focus bring photons enough into it: of 100,000 some 100.
// Those that are aimed at one caster alone are better stratified.
constexpr double kMuchWider = 32.0;

double radiusOf(const Focus& focus) {
    return 1.0 / std::sqrt(static_cast<double>(focus.inverseRadiusSquared));
}

}  // namespace

std::vector<Caster> ballsAround(const Focus& focus, double sceneRadius) {
    std::vector<Caster> balls;
    const Vec3d centre(focus.centre);
    const double whole = length(centre) + sceneRadius;
    for (double radius = radiusOf(focus); balls.size() < kMostCasters; radius *= 2) {
        balls.push_back({centre, radius});
        if (radius >= whole) break;
    }
    return balls;
}

std::vector<Caster> ballsInside(std::span<const Caster> casters, const Focus& focus) {
    std::vector<Caster> balls;
    if (focus.isEverywhere()) return balls;
    const Vec3d centre(focus.centre);
    const auto reachesInto = [&](double radius, double times) {
        return std::ranges::any_of(casters, [&](const Caster& caster) {
            return caster.radius > times * radius &&
                   length(caster.centre - centre) < caster.radius + radius;
        });
    };
    const double innermost = radiusOf(focus);
    if (!reachesInto(innermost, kMuchWider)) return balls;
    for (double radius = innermost; balls.size() < kMostBalls && reachesInto(radius, 1);
         radius *= 2)
        balls.push_back({centre, radius});
    return balls;
}

}  // namespace pm
