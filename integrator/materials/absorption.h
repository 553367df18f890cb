// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <algorithm>

#include "integrator/materials/materials.h"
#include "integrator/sampling/pinned_math.h"
#include "integrator/shapes/surface.h"
#include "integrator/values/ray.h"

namespace pm {

// What is left of light on its way to a surface that it meets from inside, by the law of Beer and
// Lambert: colour^(way / distance). Glass so thin that both its sides are met as one absorbs
// nothing. from: where the way began; direction: unit.
inline Rgb leftOnTheWay(const MaterialDescription& material, const Surface& to, const Ray& ray) {
    if (!absorbs(material) || to.isPane || !(dot(ray.direction, to.geometricNormal) > 0.0f))
        return Rgb(1.0f);
    const float ways = length(to.position - ray.origin) / material.attenuationDistance;
    const auto left = [&](float colour) {
        constexpr float kDarkest = 1e-12f;
        return pinnedPow(std::max(colour, kDarkest), ways);
    };
    const Rgb& c = material.attenuationColour;
    return {left(c.r), left(c.g), left(c.b)};
}

}  // namespace pm
