// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/materials/material_lobes.h"

#include <algorithm>
#include <cmath>

#include "integrator/materials/layers.h"
#include "integrator/materials/straight_share.h"

namespace pm {

namespace {

// A material's numbers, each with its texture, at a place.
class Numbers {
  public:
    Numbers(const Materials& materials, const Surface& surface)
        : m_materials(materials), m_surface(surface) {}

    float factor(std::int32_t texture) const { return lookUp(texture).r; }

    Rgb reflectance(const Rgb& number, std::int32_t texture) const {
        if (texture == kNoTexture) return clamped(number);
        const Texel t = lookUp(texture);
        return clamped(number * Rgb(t.r, t.g, t.b));
    }

  private:
    static Rgb clamped(const Rgb& c) { return {clamp01(c.r), clamp01(c.g), clamp01(c.b)}; }

    Texel lookUp(std::int32_t texture) const {
        return texture == kNoTexture ? Texel{1.0f, 1.0f, 1.0f, 1.0f}
                                     : m_materials.textures->lookUp(texture, contextAt(m_surface));
    }

    const Materials& m_materials;
    const Surface& m_surface;
};

float roughnessOf(const MaterialDescription& material, const Numbers& numbers) {
    return std::min(1.0f, material.roughness * numbers.factor(material.roughnessTexture));
}
// Of mirrors and glass; 0: smooth.
float alphaOf(float roughness) {
    return roughness >= kLeastRoughness ? roughness * roughness : 0.0f;
}
// Of what is never smooth; a Phong lobe that stands for it is as wide.
float leastAlphaOf(const MaterialDescription& material, const Numbers& numbers) {
    float roughness = roughnessOf(material, numbers);
    // D falls to half at .6436 alpha, which moves what is reflected twice as far, and a Phong lobe
    // at the root of 2 ln 2 / n.
    if (!(roughness > 0.0f) && material.glossyExponent > 0.0f)
        roughness = std::min(1.0f, std::sqrt(std::sqrt(0.837f / material.glossyExponent)));
    roughness = std::max(kLeastRoughness, roughness);
    return roughness * roughness;
}

template <typename Model>
void setSmooth(Model model, const LobePoint& at, Lobes& lobes) {
    const SmoothShares shares = model.shares(at);
    lobes.of(Lobe::kReflection) = shares.reflected;
    lobes.of(Lobe::kRefraction) = shares.refracted;
    lobes.smooth = model;
}

template <typename Model>
void setGlossy(const Model& lobe, const LobePoint& at, Lobes& lobes) {
    lobes.of(lobes.glossyRole) = lobe.albedo(lobe.cosine(at)) * at.opacity;
    lobes.glossy = lobe;
}

// Rough facets, longer along the tangent where they are to be.
GgxReflection facets(const MaterialDescription& material, const Surface& surface,
                     const StretchedAlbedo* stretched, float alpha, const Fresnel& fresnel) {
    GgxReflection lobe{{alpha}, fresnel};
    if (!stretched || !(lengthSquared(surface.tangent) > 0.0f)) return lobe;
    lobe.stretched = stretched;
    lobe.ggx.stretch = stretchOf(material);
    const SinCos turn = sinCosTurns(material.anisotropyRotation);
    const Frame frame(surface.shadingNormal, surface.tangent);
    lobe.tangent = frame.tangent * turn.cos +
                   frame.bitangent * (surface.isTextureMirrored ? -turn.sin : turn.sin);
    return lobe;
}

// A rough lobe, and the layer on top where there is one.
void setFacets(const MaterialDescription& material, const GgxReflection& base,
               const LayerPass* pass, const LobePoint& at, Lobes& lobes) {
    if (hasCoat(material))
        setGlossy(Layered<GgxReflection>{coatOf(material), material.coat, base, pass}, at, lobes);
    else if (hasSheen(material))
        setGlossy(Layered<Sheen>{sheenOf(material), 1.0f, base, pass}, at, lobes);
    else
        setGlossy(base, at, lobes);
}

void setTopAlone(const MaterialDescription& material, const LobePoint& at, Lobes& lobes) {
    if (hasSheen(material)) return setGlossy(sheenOf(material), at, lobes);
    setGlossy(coatOf(material), at, lobes);
    lobes.of(lobes.glossyRole) *= material.coat;
}

// What the diffuse lobe lies below: a boundary that reflects f0 at normal incidence, and layers.
void setUndercoat(const MaterialDescription& material, const Rgb& f0, float alpha,
                  const LayerPass* pass, const LobePoint& at, Lobes& lobes) {
    Cover cover;
    cover.pass = pass;
    cover.boundary = {std::min(0.99f, maxChannel(f0)), alpha};
    if (hasCoat(material)) {
        cover.coat = {normalReflectance(material.coatIor), coatAlpha(material)};
        cover.coatShare = material.coat;
    } else if (hasSheen(material)) {
        const Sheen sheen = sheenOf(material);
        cover.sheen = maxChannel(sheen.tint);
        cover.sheenRoughness = sheen.roughness;
    }
    const Undercoat below(cover);
    lobes.of(Lobe::kDiffuse) *= below.passesOut(at);
    lobes.diffuse = below;
}

// A boundary whose colour is what it reflects at normal incidence, over the diffuse lobe, and what
// is on top of it.
void setCoated(const MaterialDescription& material, const Numbers& numbers, const Surface& surface,
               const TablesOf& tables, const LobePoint& at, Lobes& lobes) {
    if (!isShinyBelow(material)) {
        setUndercoat(material, Rgb(), 0.0f, nullptr, at, lobes);
        return setTopAlone(material, at, lobes);
    }
    const Rgb f0 = numbers.reflectance(material.glossy, material.glossyTexture);
    const float alpha = leastAlphaOf(material, numbers);
    setUndercoat(material, f0, alpha, tables.pass, at, lobes);
    setFacets(material,
              facets(material, surface, tables.stretched, alpha, {Fresnel::Curve::kSchlick, f0}),
              tables.pass, at, lobes);
}

void setSurface(const MaterialDescription& material, const Numbers& numbers, const Surface& surface,
                const TablesOf& tables, const LobePoint& at, Lobes& lobes) {
    const Rgb colour = numbers.reflectance(material.diffuse, material.diffuseTexture);
    setDiffuseLobe(material, colour, lobes.diffuse);
    lobes.of(Lobe::kDiffuse) = colour * at.opacity;
    if (hasCoat(material) || hasSheen(material) ||
        (material.roughness > 0.0f && !isBlack(material.glossy)))
        return setCoated(material, numbers, surface, tables, at, lobes);
    if (isBlack(material.glossy) && !isBlack(material.diffuseTransmission)) {
        lobes.of(lobes.glossyRole) = material.diffuseTransmission * at.opacity;
        lobes.glossy = DiffuseTransmission{};
        return;
    }
    if (isBlack(material.glossy)) return;
    lobes.of(lobes.glossyRole) =
        numbers.reflectance(material.glossy, material.glossyTexture) * at.opacity;
    lobes.glossy = Phong{
        std::max(0.0f, material.glossyExponent * numbers.factor(material.glossyExponentTexture))};
}

Fresnel metalCurve(const MaterialDescription& material, const Rgb& tint) {
    if (!isBlack(material.conductorK))
        return {Fresnel::Curve::kConductor, tint, material.conductorN, material.conductorK};
    if (isBlack(material.edgeTint))
        return {material.fresnelMirror ? Fresnel::Curve::kSchlick : Fresnel::Curve::kEven, tint};
    const MetalIndex r = metalOfEdge(tint.r, material.edgeTint.r),
                     g = metalOfEdge(tint.g, material.edgeTint.g),
                     b = metalOfEdge(tint.b, material.edgeTint.b);
    return {Fresnel::Curve::kConductor, Rgb(1.0f), {r.n, g.n, b.n}, {r.k, g.k, b.k}};
}

void setMirror(const MaterialDescription& material, const Numbers& numbers, const Surface& surface,
               const TablesOf& tables, const LobePoint& at, Lobes& lobes) {
    const Rgb tint = numbers.reflectance(material.glossy, material.glossyTexture);
    const Fresnel fresnel = metalCurve(material, tint);
    if (hasCoat(material))
        return setFacets(
            material,
            facets(material, surface, tables.stretched, leastAlphaOf(material, numbers), fresnel),
            tables.pass, at, lobes);
    if (material.roughness > 0.0f) {
        const float alpha = alphaOf(roughnessOf(material, numbers));
        if (alpha == 0.0f) return setSmooth(Mirror{fresnel}, at, lobes);
        return setGlossy(facets(material, surface, tables.stretched, alpha, fresnel), at, lobes);
    }
    if (!(material.glossyExponent > 0.0f)) return setSmooth(Mirror{fresnel}, at, lobes);
    lobes.of(lobes.glossyRole) = tint * at.opacity;
    lobes.glossy = Phong{material.glossyExponent};
}

void setDielectric(const MaterialDescription& material, const Numbers& numbers,
                   const Materials& materials, std::uint32_t index, const Surface& surface,
                   const LobePoint& at, Lobes& lobes) {
    const float eta = relativeIndex(material, surface, at.isFront);
    if (isUnbending(eta)) return;  // it goes straight on
    const Rgb tint = tintAt(materials, material, surface);
    if (surface.isPane) return setSmooth(Pane{tint, eta}, at, lobes);
    const float alpha = alphaOf(
        std::min(1.0f, glassRoughness(material) * numbers.factor(material.roughnessTexture)));
    if (!(alpha > 0.0f)) return setSmooth(Dielectric{tint, eta}, at, lobes);
    const GlassAlbedo* const table = surface.eta > 0.0f
                                         ? materials.tables->glassOf(at.isFront ? eta : 1.0f / eta)
                                         : materials.tablesOf(index).glass;
    setGlossy(RoughGlass{{alpha}, tint, table, !at.isFront}, at, lobes);
}

}  // namespace

void setLobes(const Materials& materials, std::uint32_t index, const Surface& surface,
              const LobePoint& at, Lobes& lobes) {
    const MaterialDescription& material = materials[index];
    const Numbers numbers(materials, surface);
    lobes.glossyRole = glossyRoleOf(material, materials.roles);
    switch (material.kind) {
        case MaterialKind::kSurface:
            return setSurface(material, numbers, surface, materials.tablesOf(index), at, lobes);
        case MaterialKind::kMirror:
            return setMirror(material, numbers, surface, materials.tablesOf(index), at, lobes);
        case MaterialKind::kDielectric:
            return setDielectric(material, numbers, materials, index, surface, at, lobes);
        case MaterialKind::kMixture:
            return;  // its parts have some: see Bsdf
    }
}

}  // namespace pm
