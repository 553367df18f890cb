// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/formats/mtl/material_layers.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "host_shim/formats/mtl/mtl_keys.h"

namespace pm::host {
namespace {

// In [0, 1]; told where it wasn't.
float share(const MtlSection& section, const char* key, const MaterialNote& note) {
    const double value = section.number(key).value_or(0);
    const double allowed = std::clamp(value, 0.0, 1.0);
    if (allowed != value)
        note(Warning::kMaterialValue, key,
             fmt::format("{} {} is outside [0,1]; {} is taken", key, value, allowed));
    return static_cast<float>(allowed);
}

void readSheen(const MtlSection& section, const Translation& translation, MaterialData& material,
               const MaterialNote& note) {
    const float sheen = share(section, "Ps", note);
    if (sheen == 0) return;
    if (material.kind != MaterialKind::kSurface) {
        note(Warning::kMaterialPart, "Ps", "Ps is not rendered on a mirror, metal or glass");
        return;
    }
    for (std::size_t i = 0; i < 3; ++i)
        material.sheen[i] = sheen * static_cast<float>(translation.sheenTint[i]);
    material.sheenRoughness = static_cast<float>(translation.sheenRoughness);
}

void readAnisotropy(const MtlSection& section, MaterialData& material, const MaterialNote& note) {
    const float anisotropy = share(section, "aniso", note);
    if (anisotropy == 0) return;
    if (material.kind == MaterialKind::kDielectric || material.roughness == 0) {
        note(Warning::kMaterialPart, "aniso",
             "aniso is rendered on metals and surfaces with a roughness (Pr) alone, so it is left "
             "out");
        return;
    }
    material.anisotropy = anisotropy;
    material.anisotropyRotation = share(section, "anisor", note);
}

void limitStrength(Boxed<TextureUse>& use, const char* key, float least, float most,
                   const MaterialNote& note) {
    if (!use) return;
    const float given = use->strength;
    const float allowed = given >= least ? std::min(given, most) : std::max(least, -most);
    if (allowed == given) return;
    note(Warning::kMaterialValue, key,
         fmt::format("-bm {} is outside [{}, {}]; {} is taken", given, least, most, allowed));
    use->strength = allowed;
}

// Why a map is left out, where it is not only that nobody has done it yet.
std::string whyLeftOut(std::string_view key) {
    if (key == "refl" || key == "map_refl")
        return fmt::format("{} is left out: mirrors show the scene, not a picture", key);
    return fmt::format("{} is not rendered yet and left out", key);
}

}  // namespace

void readLayers(const MtlSection& section, const Translation& translation, MaterialData& material,
                const MaterialNote& note) {
    material.coat = share(section, "Pc", note);
    if (material.coat > 0) material.coatRoughness = share(section, "Pcr", note);
    readSheen(section, translation, material, note);
    readAnisotropy(section, material, note);
}

void limitStrengths(MaterialData& material, const MaterialNote& note) {
    constexpr float kMostOfNormals = 100.0f, kMostOfHeights = 1e6f;
    if (material.normalTexture && !(material.normalTexture->strength >= 0)) {
        note(Warning::kMaterialValue, "norm",
             fmt::format("-bm {} is outside [0, {}]; 1 is taken", material.normalTexture->strength,
                         kMostOfNormals));
        material.normalTexture->strength = 1.0f;
    }
    limitStrength(material.normalTexture, "norm", 0.0f, kMostOfNormals, note);
    limitStrength(material.bumpTexture, "map_bump", -kMostOfHeights, kMostOfHeights, note);
    limitStrength(material.displacementTexture, "disp", -kMostOfHeights, kMostOfHeights, note);
}

void noteLeftOut(const MtlSection& section, const MaterialNote& note) {
    std::string pictures, first;
    for (const MtlKey& key : mtlKeys()) {
        if (std::string_view(key.key) != key.meansKey) continue;
        const bool isMapOfNumber = key.kind == MtlKind::kMapOfNumber && section.hasMap(key.key);
        const bool isLeftOut =
            (key.kind == MtlKind::kMapLeftOut && section.hasMap(key.key)) ||
            (key.kind == MtlKind::kNumberLeftOut && section.number(key.key).value_or(0) != 0);
        if (isLeftOut) note(Warning::kMaterialPart, key.key, whyLeftOut(key.key));
        if (!isMapOfNumber) continue;
        const std::string number = std::string(key.key).substr(std::string_view("map_").size());
        pictures += fmt::format("{}{} ({} {:g})", pictures.empty() ? "" : ", ", key.key, number,
                                section.number(number).value_or(0));
        if (first.empty()) first = key.key;
    }
    if (!pictures.empty())
        note(Warning::kMaterialPart, first,
             fmt::format("pictures of these are not rendered yet, and one number is taken for all: "
                         "{}",
                         pictures));
}

}  // namespace pm::host
