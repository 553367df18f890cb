// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cmath>

#include "integrator/materials/opacity.h"
#include "integrator/shapes/surface.h"

namespace pm {

// Light that goes straight on where it meets a surface: what is cut away or half transparent lets a
// share of it through, and glass of the same index on both sides, which bends and reflects nothing,
// all but for its tint.

// Of an index over another: nothing is bent that a float could tell from straight.
inline bool isUnbending(float eta) {
    constexpr float kRounding = 1e-6f;
    return std::abs(eta - 1.0f) <= kRounding;
}

// Index of what is beyond a face of glass over that on the side that it is met from.
inline float relativeIndex(const MaterialDescription& material, const Surface& surface,
                           bool isFront) {
    if (surface.eta > 0.0f && !surface.isPane) return surface.eta;
    return isFront || material.thinWalled ? material.ior : 1.0f / material.ior;
}

// What glass lets pass of each channel, in [0, 1].
inline Rgb tintAt(const Materials& materials, const MaterialDescription& material,
                  const Surface& surface) {
    Rgb tint = material.transmission;
    if (material.transmissionTexture != kNoTexture) {
        const Texel t =
            materials.textures->lookUp(material.transmissionTexture, contextAt(surface));
        tint *= Rgb(t.r, t.g, t.b);
    }
    const auto clamped = [](float v) { return v > 0.0f ? std::min(v, 1.0f) : 0.0f; };
    return {clamped(tint.r), clamped(tint.g), clamped(tint.b)};
}

// Inside of glass of index n radiance is n^2 times as much as outside (Veach 1997, section 5.2): so
// is what comes in where its face is cut away, and even light stays even. The square of the index
// beyond over that on the side that the face is met from; 1 of all else.
inline float straightEtaSquared(const MaterialDescription& material, const Surface& surface,
                                bool isFront) {
    if (!isGlass(material) || surface.isPane) return 1.0f;
    const float eta = relativeIndex(material, surface, isFront);
    return isUnbending(eta) ? 1.0f : eta * eta;
}

// What glass that bends nothing lets through of what is there of it.
inline Rgb unbentShare(const Materials& materials, std::uint32_t index, const Surface& surface) {
    const MaterialDescription& material = materials[index];
    if (material.kind == MaterialKind::kDielectric) {
        const Rgb tint = tintAt(materials, material, surface);
        return (surface.isPane ? tint * tint : tint) *
               ownOpacityAt(materials, material, contextAt(surface));
    }
    if (material.kind != MaterialKind::kMixture) return {};
    const float second = weightAt(materials, material, contextAt(surface).finest());
    return (unbentShare(materials, material.first, surface) * (1.0f - second) +
            unbentShare(materials, material.second, surface) * second) *
           ownOpacityAt(materials, material, contextAt(surface));
}

// Share of the radiance beyond that is seen straight on where a ray meets the surface; above 1
// where it comes from a denser medium. opacity: there, see opacityAt(). isFront: the ray comes from
// the side of the surface's front.
inline Rgb straightShare(const Materials& materials, const Surface& surface, float opacity,
                         bool isFront) {
    const MaterialDescription& material = materials[surface.material];
    const Rgb open(1.0f - opacity);
    if (!isGlass(material)) return open;
    if (isUnbending(relativeIndex(material, surface, isFront)))
        return open + unbentShare(materials, surface.material, surface);
    return open * (1.0f / straightEtaSquared(material, surface, isFront));
}

}  // namespace pm
