// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/formats/mtl/materials.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "host_shim/formats/mtl/material_reader.h"
#include "host_shim/formats/mtl/mtl_text.h"

namespace pm::host {

namespace {

// What is the surface's whatever it is made of goes to the mixture.
void moveWhatIsShared(MaterialData& part, MaterialData& mixture) {
    mixture.transparency = std::exchange(part.transparency, 0.0f);
    mixture.emission = std::exchange(part.emission, {});
    mixture.emitsFromBothSides = part.emitsFromBothSides;
    for (Boxed<TextureUse> MaterialData::*use :
         {&MaterialData::opacityTexture, &MaterialData::emissionTexture,
          &MaterialData::normalTexture, &MaterialData::bumpTexture,
          &MaterialData::displacementTexture}) {
        mixture.*use = std::move(part.*use);
        (part.*use).reset();
    }
}

// A surface that is metal where a picture says so: the same section once as what is none, once as
// what is.
MaterialData mixedByMetal(const MtlSection& section, const MetalMap& metal, const MtlSource& source,
                          SceneFiles& files, const WarningSink& warn) {
    const WarningSink once = [](Warning, const std::string&) {};
    MaterialData mixture;
    mixture.name = section.name;
    mixture.weight = static_cast<float>(metal.factor);
    mixture.weightTexture = readMapOfNumbers(section, metal.key, source, files, warn);
    const auto alone = static_cast<float>(std::clamp(section.number("Pm").value_or(0), 0.0, 1.0));
    if (!mixture.weightTexture)
        mixture.weight = alone;
    else if (mixture.weight > 0)
        mixture.weightTexture->missing = alone / mixture.weight;
    for (const double share : {0.0, 1.0}) {
        MtlSection part = section;
        part.maps.erase(metal.key);
        part.numbers["Pm"] = share;
        MaterialData made = readSection(std::move(part), source, files, share == 0 ? warn : once);
        made.name += share == 0 ? " (no metal)" : " (metal)";
        MaterialData ignored;
        moveWhatIsShared(made, share == 0 ? mixture : ignored);
        mixture.parts.push_back(std::move(made));
    }
    return mixture;
}

}  // namespace

MaterialData defaultMaterial(const std::string& name) {
    MaterialData material;
    material.name = name;
    return material;
}

std::map<std::string, MaterialData> readMaterials(std::string_view mtlText, const MtlSource& source,
                                                  SceneFiles& files, const WarningSink& warn,
                                                  const NameFilter& isUsed) {
    std::map<std::string, MaterialData> materials;
    const auto isWanted = [&](const std::string& name) { return !isUsed || isUsed(name); };
    forEachMtlSection(mtlText, isWanted, [&](MtlSection&& section) {
        if (materials.contains(section.name)) {
            warn(Warning::kMaterialValue,
                 fmt::format("{}:{}: material {} is defined twice; the first counts",
                             source.fileName, section.lines.at("newmtl"), section.name));
            return;
        }
        std::string name = section.name;
        const auto metal = metalMapOf(source.dialect, section);
        materials.emplace(std::move(name),
                          metal ? mixedByMetal(section, *metal, source, files, warn)
                                : readSection(std::move(section), source, files, warn));
    });
    return materials;
}

}  // namespace pm::host
