// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>
#include <string>

#include "integrator/materials/texture_source.h"
#include "integrator/values/rgb.h"

namespace pm {

enum class MaterialKind { kSurface, kMirror, kDielectric };

// A material as the host gives it: numbers, each multiplied by its texture where it has one.
// Units and ranges as PmrMaterialDesc in pm_plugin.h.
struct MaterialDescription {
    std::string name;
    MaterialKind kind = MaterialKind::kSurface;
    bool fresnelMirror = false;
    Rgb diffuse;
    Rgb glossy;
    float glossyExponent = 0.0f;
    float ior = 1.5f;
    Rgb transmission{1.0f};
    Rgb emission;
    float transparency = 0.0f;
    std::int32_t diffuseTexture = kNoTexture;
    std::int32_t glossyTexture = kNoTexture;
    std::int32_t glossyExponentTexture = kNoTexture;
    std::int32_t transmissionTexture = kNoTexture;
    std::int32_t emissionTexture = kNoTexture;
    std::int32_t opacityTexture = kNoTexture;
};

// Whether the material looks up a texture.
inline bool hasTexture(const MaterialDescription& material) {
    for (const std::int32_t texture :
         {material.diffuseTexture, material.glossyTexture, material.glossyExponentTexture,
          material.transmissionTexture, material.emissionTexture, material.opacityTexture})
        if (texture != kNoTexture) return true;
    return false;
}

// Whether light can leave the material in no other way than diffusely, whatever its textures.
inline bool isDiffuseAtMost(const MaterialDescription& material) {
    return material.kind == MaterialKind::kSurface && isBlack(material.glossy) &&
           material.transparency == 0.0f && material.opacityTexture == kNoTexture;
}

// Half of a Phong lobe's greatest value lies 10 degrees aside, or farther.
inline constexpr float kMostBroadExponent = 45.0f;

// Whether the material's Phong lobe, where it has one, is so broad that it casts no caustics: light
// that it scatters is found as diffuse light is. By the number alone, whatever its texture.
inline bool isBroad(const MaterialDescription& material) {
    return material.glossyExponent <= kMostBroadExponent;
}

// Whether light can leave the material in one direction, or two, like from a mirror or glass.
inline bool mayHaveDelta(const MaterialDescription& material) {
    return material.kind != MaterialKind::kSurface || material.transparency > 0.0f ||
           material.opacityTexture != kNoTexture;
}

// Whether the material lets some light straight on and scatters some, as half-transparent sheets
// do.
inline bool isSheet(const MaterialDescription& material) {
    return material.kind == MaterialKind::kSurface && mayHaveDelta(material) &&
           !isBlack(material.diffuse);
}

// Whether light that meets the material goes nowhere from there, whatever its textures.
inline bool isBlackBody(const MaterialDescription& material) {
    return isDiffuseAtMost(material) && isBlack(material.diffuse);
}

}  // namespace pm
