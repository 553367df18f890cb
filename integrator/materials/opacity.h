// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <algorithm>

#include "integrator/materials/materials.h"
#include "integrator/shapes/surface.h"

namespace pm {

inline TextureContext contextAt(const Surface& surface) {
    return {surface.uv, surface.position, surface.footprint};
}

// Of a mixture: the second's share at a point, in [0, 1].
inline float weightAt(const Materials& materials, const MaterialDescription& mixture,
                      const TextureContext& at) {
    float weight = mixture.weight;
    if (mixture.weightTexture != kNoTexture)
        weight *= materials.textures->lookUp(mixture.weightTexture, at).r;
    return weight > 0.0f ? std::min(weight, 1.0f) : 0.0f;
}

// By a material's own numbers.
inline float ownOpacityAt(const Materials& materials, const MaterialDescription& material,
                          const TextureContext& at) {
    float opacity = 1.0f - material.transparency;
    if (material.opacityTexture != kNoTexture)
        opacity *= materials.textures->lookUp(material.opacityTexture, at.finest()).r;
    return opacity > 0.0f ? std::min(opacity, 1.0f) : 0.0f;
}

// Share of the surface that is there at a point, in [0, 1]. Always by the finest level: shadow
// rays, which have no footprint, are to meet what all others meet.
inline float opacityAt(const Materials& materials, std::uint32_t index, const TextureContext& at) {
    const MaterialDescription& material = materials[index];
    const float own = ownOpacityAt(materials, material, at);
    if (material.kind != MaterialKind::kMixture || own == 0.0f) return own;
    const float second = weightAt(materials, material, at.finest());
    float parts = 0.0f;
    if (second < 1.0f) parts += (1.0f - second) * opacityAt(materials, material.first, at);
    if (second > 0.0f) parts += second * opacityAt(materials, material.second, at);
    return own * parts;
}

}  // namespace pm
