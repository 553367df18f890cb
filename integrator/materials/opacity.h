// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <algorithm>

#include "integrator/materials/materials.h"
#include "integrator/values/vec.h"

namespace pm {

// Whether a share of the surface is not there.
inline bool isCutAway(const MaterialDescription& material) {
    return material.transparency > 0.0f || material.opacityTexture != kNoTexture;
}
// Whether light may go straight on where it meets the material, whatever is on its sides.
inline bool letsThrough(const MaterialDescription& material) {
    return isCutAway(material) || isUnbending(material);
}

// Share of the light at a point that does not go straight on, in [0, 1]. Always by the finest
// level: shadow rays, which have no footprint, are to meet what all others meet.
inline float opacityAt(const Materials& materials, const MaterialDescription& material, Vec2f uv) {
    float opacity = 1.0f - material.transparency;
    if (material.opacityTexture != kNoTexture)
        opacity *= materials.textures->lookUp(material.opacityTexture, uv, {}).r;
    return opacity > 0.0f ? std::min(opacity, 1.0f) : 0.0f;
}

}  // namespace pm
