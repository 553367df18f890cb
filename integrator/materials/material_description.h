// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cmath>
#include <cstdint>
#include <string>

#include "integrator/materials/texture_source.h"
#include "integrator/values/rgb.h"

namespace pm {

// Only what is in this folder asks for it; all else asks what a material can do, MaterialTraits.
enum class MaterialKind { kSurface, kMirror, kDielectric, kMixture };

// A material as the host gives it: numbers, each multiplied by its texture where it has one.
// Units and ranges as PmrMaterialDesc in pm_plugin.h.
struct MaterialDescription {
    std::string name;
    MaterialKind kind = MaterialKind::kSurface;
    bool fresnelMirror = false;
    Rgb diffuse;
    float diffuseRoughness = 0.0f;  // of plaster or clay, in [0, 1]
    Rgb diffuseTransmission;        // where there is nothing glossy
    Rgb glossy;
    float glossyExponent = 0.0f;
    float roughness = 0.0f;      // of facets; 0: by the exponent, or smooth
    Rgb conductorN, conductorK;  // of metal; k black: the colour is its reflectance at any angle
    float ior = 1.5f;
    Rgb transmission{1.0f};
    Rgb emission;
    Rgb attenuationColour{1.0f};       // of a dielectric: what is left of light after the distance
    float attenuationDistance = 0.0f;  // scene units; 0: it absorbs nothing
    float transparency = 0.0f;
    float coat = 0.0f;  // clear, over all else: the share that it covers, in [0, 1]
    float coatRoughness = 0.0f;
    float coatIor = 1.5f;
    Rgb sheen;  // of cloth, over a surface
    float sheenRoughness = 0.3f;
    Rgb edgeTint;                     // of metal; black: none is given
    float anisotropy = 0.0f;          // of roughness, in [0, 1]: along the tangent it is more
    float anisotropyRotation = 0.0f;  // of that, in turns from the tangent towards the bitangent
    std::int32_t priority = 0;        // of a dielectric where several are: the highest is there
    bool thinWalled = false;          // a dielectric: its surface is all there is of it
    std::int32_t diffuseTexture = kNoTexture;
    std::int32_t glossyTexture = kNoTexture;
    std::int32_t glossyExponentTexture = kNoTexture;
    std::int32_t roughnessTexture = kNoTexture;
    std::int32_t transmissionTexture = kNoTexture;
    std::int32_t emissionTexture = kNoTexture;
    std::int32_t opacityTexture = kNoTexture;
    std::int32_t normalTexture =
        kNoTexture;                         // in tangent space, its components as 8 bits have them
    float normalScale = 1.0f;               // of the components along the surface
    std::int32_t bumpTexture = kNoTexture;  // heights
    float bumpScale = 1.0f;                 // scene units of a height of 1
    // Of a mixture: the numbers of two others, and the share of the second where the texture is 1.
    // Of its own it has what shapes the surface, the maps of normals, bumps and displacement, and
    // an emission and a cut-out that count beside theirs.
    std::uint32_t first = 0, second = 0;
    float weight = 0.0f;
    std::int32_t weightTexture = kNoTexture;
    bool hasGlass = false;  // a part is glass: the medium is that one's; see completeMixtures()
    // Heights by which limit surfaces are displaced along their normal.
    std::int32_t displacementTexture = kNoTexture;
    float displacementScale = 1.0f;  // scene units of a height of 1
};

// Whether its faces bound a medium, or are panes.
inline bool isGlass(const MaterialDescription& material) {
    return material.kind == MaterialKind::kDielectric || material.hasGlass;
}

// Whether light loses on its way inside.
inline bool absorbs(const MaterialDescription& material) {
    return isGlass(material) && material.attenuationDistance > 0.0f &&
           material.attenuationColour != Rgb(1.0f);
}

// Whether the material looks up a texture.
inline bool hasTexture(const MaterialDescription& material) {
    for (const std::int32_t texture :
         {material.diffuseTexture, material.glossyTexture, material.glossyExponentTexture,
          material.roughnessTexture, material.transmissionTexture, material.emissionTexture,
          material.opacityTexture, material.normalTexture, material.bumpTexture,
          material.weightTexture})
        if (texture != kNoTexture) return true;
    return false;
}

// Whether there is a clear coat on it, or fibres: the layer on top, one at most.
inline bool hasCoat(const MaterialDescription& material) {
    return material.coat > 0.0f && material.kind != MaterialKind::kDielectric;
}
inline bool hasSheen(const MaterialDescription& material) {
    return material.kind == MaterialKind::kSurface && !isBlack(material.sheen) &&
           !hasCoat(material);
}

// Whether what lies below that layer reflects like a mirror, or as the boundary of plastic.
inline bool isShinyBelow(const MaterialDescription& material) {
    return material.kind == MaterialKind::kMirror ||
           (material.kind == MaterialKind::kSurface && !isBlack(material.glossy));
}

// Whether a rough lobe lies below a layer.
inline bool isLayered(const MaterialDescription& material) {
    return (hasCoat(material) || hasSheen(material)) && isShinyBelow(material);
}

// Of glass: its own, and that of a coat on it.
inline float glassRoughness(const MaterialDescription& material) {
    if (material.thinWalled) return 0.0f;
    if (!(material.coat > 0.0f && material.coatRoughness > 0.0f)) return material.roughness;
    const float own = material.roughness * material.roughness;
    const float coat = material.coatRoughness * material.coatRoughness;
    return std::sqrt(std::sqrt(own * own + material.coat * coat * coat));
}

inline bool isRoughGlass(const MaterialDescription& material) {
    return material.kind == MaterialKind::kDielectric && glassRoughness(material) > 0.0f;
}

// Whether all that is glossy of it has at least that roughness of facets, or at most that exponent
// of a Phong lobe: what lies below layers, and these. By the numbers alone, whatever their
// textures.
inline bool isAtLeastAsRough(const MaterialDescription& material, float roughness, float exponent) {
    if (hasCoat(material) && material.coatRoughness < roughness) return false;
    if ((hasCoat(material) || hasSheen(material)) && !isShinyBelow(material)) return true;
    const float own =
        material.kind == MaterialKind::kDielectric ? glassRoughness(material) : material.roughness;
    // Below a coat a mirror is the least rough that there is.
    if (hasCoat(material) && material.kind == MaterialKind::kMirror && own == 0.0f &&
        material.glossyExponent == 0.0f)
        return false;
    return own > 0.0f ? own >= roughness : material.glossyExponent <= exponent;
}

// Glass of index 1 that no priority puts in place of other glass: where nothing else is, it neither
// bends nor reflects.
inline bool isUnbending(const MaterialDescription& material) {
    constexpr float kRounding = 1e-6f;
    return material.kind == MaterialKind::kDielectric && material.priority == 0 &&
           std::abs(material.ior - 1.0f) <= kRounding;
}
}  // namespace pm
