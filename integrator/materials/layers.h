// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <algorithm>
#include <cmath>

#include "integrator/materials/lobes/layered.h"
#include "integrator/materials/material_description.h"

namespace pm {

// What the numbers of a material make of its layers and facets.

// Of what is smoother, slopes can't be told from none in floats.
inline constexpr float kLeastRoughness = 1e-2f;

inline float normalReflectance(float ior) {
    const float root = (ior - 1.0f) / (ior + 1.0f);
    return root * root;
}

inline float coatAlpha(const MaterialDescription& material) {
    const float roughness = std::max(kLeastRoughness, material.coatRoughness);
    return roughness * roughness;
}

inline GgxReflection coatOf(const MaterialDescription& material) {
    return {{coatAlpha(material)},
            {Fresnel::Curve::kSchlick, Rgb(normalReflectance(material.coatIor))}};
}

inline Sheen sheenOf(const MaterialDescription& material) {
    return {std::clamp(material.sheenRoughness, kLeastSheenRoughness, 1.0f), material.sheen};
}

// How much longer facets' highlights are along the tangent. Source: Burley, "Physically Based
// Shading at Disney", SIGGRAPH 2012 course.
inline bool isStretched(const MaterialDescription& material) {
    return material.anisotropy > 0.0f && isShinyBelow(material);
}
inline float stretchOf(const MaterialDescription& material) {
    return 1.0f / std::sqrt(1.0f - 0.9f * material.anisotropy);
}

// What the layer on top lets pass; a material has one at most: a coat hides fibres.
inline float passesTop(const MaterialDescription& material, float cosine) {
    if (material.coat > 0.0f) return passesBelow(coatOf(material), material.coat, cosine);
    return passesBelow(sheenOf(material), 1.0f, cosine);
}

}  // namespace pm
