// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <algorithm>

#include "integrator/materials/materials.h"
#include "integrator/sampling/pinned_math.h"
#include "integrator/shapes/surface.h"
#include "integrator/values/ray.h"

namespace pm {

// What is left of light on a way through a medium, scene units, by the law of Beer and Lambert:
// colour^(way / distance).
inline Rgb leftAfter(const MaterialDescription& material, float way) {
    if (!absorbs(material)) return Rgb(1.0f);
    constexpr float kMost = 1e30f;  // of ways to infinity
    const float ways = std::min(kMost, way / material.attenuationDistance);
    const auto left = [&](float colour) {
        constexpr float kDarkest = 1e-12f;
        return pinnedPow(std::max(colour, kDarkest), ways);
    };
    const Rgb& c = material.attenuationColour;
    return {left(c.r), left(c.g), left(c.b)};
}

// The same on the way to a surface that it meets from inside. Glass so thin that both its sides are
// met as one absorbs nothing. ray: that led there.
inline Rgb leftOnTheWay(const MaterialDescription& material, const Surface& to, const Ray& ray) {
    if (to.isPane || !(dot(ray.direction, to.geometricNormal) > 0.0f)) return Rgb(1.0f);
    return leftAfter(material, length(to.position - ray.origin));
}

}  // namespace pm
