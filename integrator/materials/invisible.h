// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cmath>

#include "integrator/materials/material_description.h"

namespace pm {

// Whether light passes as if nothing were there: clear glass of index 1. What has such a material
// is met by no ray.
inline bool isInvisible(const MaterialDescription& material) {
    constexpr float kRounding = 1e-6f;
    return material.kind == MaterialKind::kDielectric &&
           std::abs(material.ior - 1.0f) <= kRounding && material.transmission == Rgb(1.0f) &&
           material.transmissionTexture == kNoTexture && isBlack(material.emission);
}

}  // namespace pm
