// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/materials/material_lobes.h"

#include <algorithm>

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
        return texture == kNoTexture
                   ? Texel{1.0f, 1.0f, 1.0f, 1.0f}
                   : m_materials.textures->lookUp(texture, m_surface.uv, m_surface.footprint);
    }

    const Materials& m_materials;
    const Surface& m_surface;
};

// Of what is smoother, slopes can't be told from none in floats.
constexpr float kLeastRoughness = 1e-2f;

float roughnessOf(const MaterialDescription& material, const Numbers& numbers) {
    return std::min(1.0f, material.roughness * numbers.factor(material.roughnessTexture));
}
// Of mirrors and glass; 0: smooth.
float alphaOf(const MaterialDescription& material, const Numbers& numbers) {
    const float roughness = roughnessOf(material, numbers);
    return roughness >= kLeastRoughness ? roughness * roughness : 0.0f;
}

template <typename Model>
void setSmooth(Model model, const LobePoint& at, Lobes& lobes) {
    const SmoothShares shares = model.shares(at);
    lobes.of(Lobe::kReflection) = shares.reflected;
    lobes.of(Lobe::kRefraction) = shares.refracted;
    lobes.smooth = model;
}

// A boundary whose colour is what it reflects at normal incidence, over the diffuse lobe.
void setCoat(const MaterialDescription& material, const Numbers& numbers, const LobePoint& at,
             Lobes& lobes) {
    const Rgb f0 = numbers.reflectance(material.glossy, material.glossyTexture);
    const float roughness = std::max(kLeastRoughness, roughnessOf(material, numbers));
    const float alpha = roughness * roughness;
    const Fresnel fresnel{Fresnel::Curve::kSchlick, f0};
    const Undercoat below{{std::min(0.99f, maxChannel(f0)), alpha}};
    lobes.of(Lobe::kDiffuse) *= below.passesOut(at);
    lobes.diffuse = below;
    const GgxReflection lobe{{alpha}, fresnel};
    lobes.of(lobes.glossyRole) = lobe.albedo(lobe.cosine(at)) * at.opacity;
    lobes.glossy = lobe;
}

void setSurface(const MaterialDescription& material, const Numbers& numbers, const LobePoint& at,
                Lobes& lobes) {
    const Rgb colour = numbers.reflectance(material.diffuse, material.diffuseTexture);
    setDiffuseLobe(material, colour, lobes.diffuse);
    lobes.of(Lobe::kDiffuse) = colour * at.opacity;
    if (isBlack(material.glossy) && !isBlack(material.diffuseTransmission)) {
        lobes.of(lobes.glossyRole) = material.diffuseTransmission * at.opacity;
        lobes.glossy = DiffuseTransmission{};
        return;
    }
    if (isBlack(material.glossy)) return;
    if (material.roughness > 0.0f) return setCoat(material, numbers, at, lobes);
    lobes.of(lobes.glossyRole) =
        numbers.reflectance(material.glossy, material.glossyTexture) * at.opacity;
    lobes.glossy = Phong{
        std::max(0.0f, material.glossyExponent * numbers.factor(material.glossyExponentTexture))};
}

Fresnel metalCurve(const MaterialDescription& material, const Rgb& tint) {
    if (!isBlack(material.conductorK))
        return {Fresnel::Curve::kConductor, tint, material.conductorN, material.conductorK};
    return {material.fresnelMirror ? Fresnel::Curve::kSchlick : Fresnel::Curve::kEven, tint};
}

void setMetal(const MaterialDescription& material, const Numbers& numbers, const Rgb& tint,
              const LobePoint& at, Lobes& lobes) {
    const float alpha = alphaOf(material, numbers);
    const Fresnel fresnel = metalCurve(material, tint);
    if (alpha == 0.0f) return setSmooth(Mirror{fresnel}, at, lobes);
    const GgxReflection lobe{{alpha}, fresnel};
    lobes.of(lobes.glossyRole) = lobe.albedo(lobe.cosine(at)) * at.opacity;
    lobes.glossy = lobe;
}

void setMirror(const MaterialDescription& material, const Numbers& numbers, const LobePoint& at,
               Lobes& lobes) {
    const Rgb tint = numbers.reflectance(material.glossy, material.glossyTexture);
    if (material.roughness > 0.0f) return setMetal(material, numbers, tint, at, lobes);
    if (!(material.glossyExponent > 0.0f))
        return setSmooth(Mirror{metalCurve(material, tint)}, at, lobes);
    lobes.of(lobes.glossyRole) = tint * at.opacity;
    lobes.glossy = Phong{material.glossyExponent};
}

void setDielectric(const MaterialDescription& material, const Numbers& numbers, const LobePoint& at,
                   bool isPane, const GlassAlbedo* glass, Lobes& lobes) {
    const Rgb tint = numbers.reflectance(material.transmission, material.transmissionTexture);
    const float alpha = isPane ? 0.0f : alphaOf(material, numbers);
    if (alpha > 0.0f) {
        const RoughGlass lobe{{alpha}, tint, glass, !at.isFront};
        lobes.of(lobes.glossyRole) = lobe.albedo(lobe.cosine(at)) * at.opacity;
        lobes.glossy = lobe;
        return;
    }
    const float eta = at.isFront ? material.ior : 1.0f / material.ior;
    if (isPane)
        setSmooth(Pane{tint, eta}, at, lobes);
    else
        setSmooth(Dielectric{tint, eta}, at, lobes);
}

}  // namespace

void setLobes(const Materials& materials, const Surface& surface, const LobePoint& at,
              Lobes& lobes) {
    const MaterialDescription& material = materials[surface.material];
    const Numbers numbers(materials, surface);
    lobes.glossyRole = isBroad(material) ? Lobe::kBroad : Lobe::kGlossy;
    switch (material.kind) {
        case MaterialKind::kSurface:
            return setSurface(material, numbers, at, lobes);
        case MaterialKind::kMirror:
            return setMirror(material, numbers, at, lobes);
        case MaterialKind::kDielectric:
            return setDielectric(material, numbers, at, surface.isPane,
                                 materials.glassOf(surface.material), lobes);
    }
}

}  // namespace pm
