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
        : m_materials(materials), m_uv(surface.uv) {}

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
                                     : m_materials.textures->lookUp(texture, m_uv, 0.0f);
    }

    const Materials& m_materials;
    Vec2f m_uv;
};

void setSurface(const MaterialDescription& material, const Numbers& numbers, const LobePoint& at,
                Lobes& lobes) {
    lobes.diffuse = diffuseLobe(material);
    lobes.of(Lobe::kDiffuse) =
        numbers.reflectance(material.diffuse, material.diffuseTexture) * at.opacity;
    if (isBlack(material.glossy)) return;
    lobes.of(lobes.glossyRole) =
        numbers.reflectance(material.glossy, material.glossyTexture) * at.opacity;
    lobes.glossy = Phong{
        std::max(0.0f, material.glossyExponent * numbers.factor(material.glossyExponentTexture))};
}

template <typename Model>
void setSmooth(const Model& model, const LobePoint& at, Lobes& lobes) {
    const SmoothShares shares = model.shares(at);
    lobes.of(Lobe::kReflection) = shares.reflected;
    lobes.of(Lobe::kRefraction) = shares.refracted;
    lobes.smooth = model;
}

void setMirror(const MaterialDescription& material, const Numbers& numbers, const LobePoint& at,
               Lobes& lobes) {
    const Rgb tint = numbers.reflectance(material.glossy, material.glossyTexture);
    if (!(material.glossyExponent > 0.0f))
        return setSmooth(Mirror{tint, material.fresnelMirror}, at, lobes);
    lobes.of(lobes.glossyRole) = tint * at.opacity;
    lobes.glossy = Phong{material.glossyExponent};
}

void setDielectric(const MaterialDescription& material, const Numbers& numbers, const LobePoint& at,
                   bool isPane, Lobes& lobes) {
    const Rgb tint = numbers.reflectance(material.transmission, material.transmissionTexture);
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
            return setDielectric(material, numbers, at, surface.isPane, lobes);
    }
}

}  // namespace pm
