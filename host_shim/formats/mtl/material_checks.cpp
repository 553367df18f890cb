// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/formats/mtl/material_checks.h"

#include <fmt/format.h>

#include <algorithm>

namespace pm::host {
namespace {

bool isBlack(const std::array<float, 3>& colour) {
    return std::ranges::all_of(colour, [](float channel) { return channel == 0; });
}

bool isCutAway(const MaterialData& material) {
    return material.kind != MaterialKind::kDielectric && material.transparency == 1;
}

bool isGlassOfAir(const MaterialData& material) {
    return material.kind == MaterialKind::kDielectric && material.ior == 1;
}

bool reflectsNothing(const MaterialData& material) {
    return material.kind != MaterialKind::kDielectric && isBlack(material.diffuse) &&
           isBlack(material.glossy);
}

}  // namespace

void warnOfUnlikelyMaterials(std::span<const MaterialData> materials, const std::string& sceneName,
                             const WarningSink& warn) {
    std::size_t count = 0, cutAway = 0, ofAir = 0, black = 0;
    for (const MaterialData& material : materials) {
        if (material.emits()) continue;
        ++count;
        cutAway += isCutAway(material) ? 1 : 0;
        ofAir += isGlassOfAir(material) ? 1 : 0;
        black += reflectsNothing(material) ? 1 : 0;
    }
    if (count == 0) return;
    const auto tell = [&](const char* text) {
        warn(Warning::kMaterialValue,
             fmt::format("{}: {} material{} that give{} no light: {}", sceneName,
                         count == 1 ? "the one" : fmt::format("all {}", count),
                         count == 1 ? "" : "s", count == 1 ? "s" : "", text));
    };
    if (cutAway == count)
        tell(
            "fully transparent, so nothing is seen; where d 0 or Tr 1 is meant to be opaque, write "
            "d 1 into the MTL file");
    else if (ofAir == count)
        tell(
            "glass of Ni 1, so nothing is seen; Maya writes illum 4 for what is opaque: "
            "--mtl-dialect maya");
    else if (black == count)
        tell(
            "black, so only lamps are seen; give Kd a colour, or leave it out beside a map_Kd, "
            "which it multiplies");
}

}  // namespace pm::host
