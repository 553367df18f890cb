// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cmath>
#include <cstdint>
#include <string>

#include "integrator/materials/texture_source.h"
#include "integrator/values/rgb.h"

namespace pm {

// Only what is in this folder and the scene asks for it; what follows light asks what a material
// can do, below.
enum class MaterialKind { kSurface, kMirror, kDielectric };

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
    // Heights by which limit surfaces are displaced along their normal.
    std::int32_t displacementTexture = kNoTexture;
    float displacementScale = 1.0f;  // scene units of a height of 1
};

// Whether light loses on its way inside.
inline bool absorbs(const MaterialDescription& material) {
    return material.kind == MaterialKind::kDielectric && material.attenuationDistance > 0.0f &&
           material.attenuationColour != Rgb(1.0f);
}

// Whether the material looks up a texture.
inline bool hasTexture(const MaterialDescription& material) {
    for (const std::int32_t texture :
         {material.diffuseTexture, material.glossyTexture, material.glossyExponentTexture,
          material.roughnessTexture, material.transmissionTexture, material.emissionTexture,
          material.opacityTexture, material.normalTexture, material.bumpTexture})
        if (texture != kNoTexture) return true;
    return false;
}

// Whether it looks up one that is filtered over what a ray covers: of what is cut away, and of
// light, it is always the finest level.
inline bool filtersTexture(const MaterialDescription& material) {
    for (const std::int32_t texture :
         {material.diffuseTexture, material.glossyTexture, material.glossyExponentTexture,
          material.roughnessTexture, material.transmissionTexture, material.normalTexture,
          material.bumpTexture})
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

// Whether light can leave the material in no other way than diffusely, whatever its textures.
inline bool isDiffuseAtMost(const MaterialDescription& material) {
    return material.kind == MaterialKind::kSurface && isBlack(material.glossy) &&
           isBlack(material.diffuseTransmission) && !hasCoat(material) && !hasSheen(material) &&
           material.transparency == 0.0f && material.opacityTexture == kNoTexture;
}

// Half of a Phong lobe's greatest value lies 10 degrees aside, or farther.
inline constexpr float kMostBroadExponent = 45.0f;

// The same of facets: they have half of D's greatest value 5 degrees aside.
inline constexpr float kLeastBroadRoughness = 0.369f;

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

// Whether the material's glossy lobe, where it has one, is so broad that it casts no caustics:
// light that it scatters is found as diffuse light is. Glass is never: what goes through it is none
// of the surface's.
inline bool isBroad(const MaterialDescription& material) {
    return material.kind != MaterialKind::kDielectric &&
           isAtLeastAsRough(material, kLeastBroadRoughness, kMostBroadExponent);
}

// From this roughness of facets on, or up to the exponent of a Phong lobe as wide, a ray along a
// lobe seldom finds a lamp's image: photons do it better.
inline constexpr float kLeastWideRoughness = 0.25f, kMostWideExponent = 510.0f;

// Whether the material's glossy lobe, where it has one, is so wide that it receives caustics as a
// diffuse one does. Broad ones are, too.
inline bool isWide(const MaterialDescription& material) {
    return isAtLeastAsRough(material, kLeastWideRoughness, kMostWideExponent);
}

// Whether light that a mirror or glass sends on is spread.
inline bool isRough(const MaterialDescription& material) {
    return material.roughness > 0.0f || material.glossyExponent > 0.0f || hasCoat(material);
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

// Whether light may go on behind the material, through glass or straight.
inline bool mayTransmit(const MaterialDescription& material) {
    return material.kind == MaterialKind::kDielectric || material.transparency > 0.0f ||
           material.opacityTexture != kNoTexture;
}

// Whether the material has a diffuse lobe: photons may be kept at it.
inline bool reflectsDiffusely(const MaterialDescription& material) {
    return material.kind == MaterialKind::kSurface && !isBlack(material.diffuse);
}

// Whether the material may have a lobe that is glossy or broad.
inline bool mayBeGlossy(const MaterialDescription& material) {
    return (material.kind == MaterialKind::kSurface &&
            !(isBlack(material.glossy) && isBlack(material.diffuseTransmission) &&
              !hasCoat(material) && !hasSheen(material))) ||
           (material.kind == MaterialKind::kMirror && isRough(material)) || isRoughGlass(material);
}

// Whether the numbers are those of a broad lobe. So may glass have them, to no effect on what it
// does; times that the plan expects count it.
inline bool hasBroadNumbers(const MaterialDescription& material) {
    return (!isBlack(material.glossy) || hasCoat(material) || hasSheen(material)) &&
           isBroad(material) && (material.kind == MaterialKind::kSurface || isRough(material));
}

// Whether light that meets the material goes nowhere from there, whatever its textures.
inline bool isBlackBody(const MaterialDescription& material) {
    return isDiffuseAtMost(material) && isBlack(material.diffuse);
}

// Glass of index 1 that no priority puts in place of other glass: where nothing else is, it neither
// bends nor reflects.
inline bool isUnbending(const MaterialDescription& material) {
    constexpr float kRounding = 1e-6f;
    return material.kind == MaterialKind::kDielectric && material.priority == 0 &&
           std::abs(material.ior - 1.0f) <= kRounding;
}
// Whether light passes as if nothing were there: such glass, clear. What has such a material is met
// by no ray.
inline bool isInvisible(const MaterialDescription& material) {
    return isUnbending(material) && !absorbs(material) && material.transmission == Rgb(1.0f) &&
           material.transmissionTexture == kNoTexture && isBlack(material.emission);
}

// Whether a medium fills what its faces enclose.
inline bool fillsItsInside(const MaterialDescription& material) {
    return material.kind == MaterialKind::kDielectric && !material.thinWalled &&
           !isInvisible(material);
}

// What a lobe may reflect and still count as carrying nothing: far less than one photon a pass
// would bring.
inline constexpr float kCarriesNothing = 1e-6f;

// Whether light can leave a surface of this material other than diffusely, by a broad lobe or
// straight on, which makes it caustic.
inline bool castsCaustics(const MaterialDescription& material) {
    if (isDiffuseAtMost(material) || isUnbending(material)) return false;
    if (material.kind != MaterialKind::kDielectric && !material.fresnelMirror &&
        !hasCoat(material) && material.glossyTexture == kNoTexture &&
        !(maxChannel(material.glossy) > kCarriesNothing))
        return false;
    const bool mayBeBroad = material.kind == MaterialKind::kSurface ||
                            (material.kind == MaterialKind::kMirror && isRough(material));
    return !(mayBeBroad && isBroad(material));
}

}  // namespace pm
