// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/materials/material_traits.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>

#include "integrator/materials/layers.h"
#include "integrator/values/error.h"

namespace pm {

namespace {

// Whether it looks up one that is filtered over what a ray covers: of what is cut away, and of
// light, it is always the finest level.
bool filtersTexture(const MaterialDescription& material) {
    for (const std::int32_t texture :
         {material.diffuseTexture, material.glossyTexture, material.glossyExponentTexture,
          material.roughnessTexture, material.transmissionTexture, material.normalTexture,
          material.bumpTexture})
        if (texture != kNoTexture) return true;
    return false;
}

// Whether light can leave the material in no other way than diffusely, whatever its textures.
bool isDiffuseAtMost(const MaterialDescription& material) {
    return material.kind == MaterialKind::kSurface && isBlack(material.glossy) &&
           isBlack(material.diffuseTransmission) && !hasCoat(material) && !hasSheen(material) &&
           material.transparency == 0.0f && material.opacityTexture == kNoTexture;
}

// Whether light that a mirror or glass sends on is spread.
bool isRough(const MaterialDescription& material) {
    return material.roughness > 0.0f || material.glossyExponent > 0.0f || hasCoat(material);
}

// What a lobe may reflect and still count as carrying nothing: far less than one photon a pass
// would bring.
constexpr float kCarriesNothing = 1e-6f;

bool isCutAway(const MaterialDescription& material) {
    return material.transparency > 0.0f || material.opacityTexture != kNoTexture;
}

// Whether the material may have a lobe that is glossy, wide or broad.
bool mayBeGlossy(const MaterialDescription& material) {
    return (material.kind == MaterialKind::kSurface &&
            !(isBlack(material.glossy) && isBlack(material.diffuseTransmission) &&
              !hasCoat(material) && !hasSheen(material))) ||
           (material.kind == MaterialKind::kMirror && isRough(material)) || isRoughGlass(material);
}

// Whether the numbers are those of a broad lobe. So may glass have them, to no effect on what it
// does.
bool hasBroadNumbers(const MaterialDescription& material, bool isBroad) {
    return (!isBlack(material.glossy) || hasCoat(material) || hasSheen(material)) && isBroad &&
           (material.kind == MaterialKind::kSurface || isRough(material));
}

bool castsCaustics(const MaterialDescription& material, bool isBroad) {
    if (isDiffuseAtMost(material) || isUnbending(material)) return false;
    if (material.kind != MaterialKind::kDielectric && !material.fresnelMirror &&
        !hasCoat(material) && material.glossyTexture == kNoTexture &&
        !(maxChannel(material.glossy) > kCarriesNothing))
        return false;
    const bool mayBeBroad = material.kind == MaterialKind::kSurface ||
                            (material.kind == MaterialKind::kMirror && isRough(material));
    return !(mayBeBroad && isBroad);
}

MaterialTraits traitsOfOne(const MaterialDescription& m, const LobeRoles& roles) {
    const Lobe role = glossyRoleOf(m, roles);
    const bool isBroad = role == Lobe::kBroad, isSurface = m.kind == MaterialKind::kSurface;
    MaterialTraits t;
    t.isBlack = isDiffuseAtMost(m) && isBlack(m.diffuse);
    t.isGlass = m.kind == MaterialKind::kDielectric;
    t.isCutAway = isCutAway(m);
    t.isUnbending = isUnbending(m);
    t.absorbs = absorbs(m);
    t.isInvisible = t.isUnbending && !t.absorbs && m.transmission == Rgb(1.0f) &&
                    m.transmissionTexture == kNoTexture && isBlack(m.emission);
    t.isOpaque = !t.isGlass && !t.isCutAway && isBlack(m.diffuseTransmission);
    t.isOfSurface = isSurface;
    t.isDiffuse = isSurface && !isBlack(m.diffuse);
    t.isGlossy = mayBeGlossy(m);
    t.isWide = t.isGlossy && role != Lobe::kGlossy;
    t.castsCaustics = castsCaustics(m, isBroad);
    t.hasDelta = !isSurface || t.isCutAway;
    t.transmits = t.isGlass || t.isCutAway;
    t.isThinWalled = m.thinWalled;
    t.fillsItsInside = t.isGlass && !m.thinWalled && !t.isInvisible;
    t.isStretched = isStretched(m);
    t.emits = !isBlack(m.emission);
    t.shinesUnevenly = m.emissionTexture != kNoTexture || t.isCutAway;
    t.filtersTextures = filtersTexture(m);
    t.looksUpTextures = hasTexture(m);
    t.hasBroadNumbers = hasBroadNumbers(m, isBroad);
    return t;
}

// Of both, beside what a mixture has of its own.
MaterialTraits traitsOfMixture(const MaterialDescription& own, const MaterialTraits& a,
                               const MaterialTraits& b) {
    MaterialTraits t = a;
    for (bool MaterialTraits::*all :
         {&MaterialTraits::isBlack, &MaterialTraits::isInvisible, &MaterialTraits::isOpaque,
          &MaterialTraits::isOfSurface, &MaterialTraits::isUnbending})
        t.*all = a.*all && b.*all;
    for (bool MaterialTraits::*any :
         {&MaterialTraits::isDiffuse, &MaterialTraits::isGlossy, &MaterialTraits::isWide,
          &MaterialTraits::castsCaustics, &MaterialTraits::hasDelta, &MaterialTraits::transmits,
          &MaterialTraits::isGlass, &MaterialTraits::fillsItsInside, &MaterialTraits::isThinWalled,
          &MaterialTraits::absorbs, &MaterialTraits::isCutAway, &MaterialTraits::isStretched,
          &MaterialTraits::emits, &MaterialTraits::shinesUnevenly, &MaterialTraits::filtersTextures,
          &MaterialTraits::looksUpTextures, &MaterialTraits::hasBroadNumbers})
        t.*any = a.*any || b.*any;
    const bool isCut = isCutAway(own), isTextured = own.weightTexture != kNoTexture;
    t.isCutAway = t.isCutAway || isCut;
    t.hasDelta = t.hasDelta || isCut;
    t.transmits = t.transmits || isCut;
    t.isOpaque = t.isOpaque && !isCut;
    t.isBlack = t.isBlack && !isCut;
    t.isInvisible = t.isInvisible && !isCut;
    t.emits = t.emits || !isBlack(own.emission);
    t.shinesUnevenly = t.shinesUnevenly || isCut || isTextured || a.emits || b.emits ||
                       own.emissionTexture != kNoTexture;
    t.filtersTextures = t.filtersTextures || isTextured || filtersTexture(own);
    t.looksUpTextures = t.looksUpTextures || hasTexture(own);
    return t;
}

// Completes mixtures, each after its parts.
class Completed {
  public:
    explicit Completed(std::vector<MaterialDescription>& materials)
        : m_materials(materials), m_parts(materials.size()), m_isOpen(materials.size()) {}

    // How many parts it has that are no mixtures.
    std::size_t parts(std::uint32_t index) {
        if (m_parts[index] > 0) return m_parts[index];
        MaterialDescription& m = m_materials[index];
        if (m.kind != MaterialKind::kMixture) return m_parts[index] = 1;
        if (m_isOpen[index]) fail(m, "names itself");
        m_isOpen[index] = true;
        std::size_t sum = 0;
        for (const std::uint32_t part : {m.first, m.second}) {
            if (part >= m_materials.size())
                fail(m, fmt::format("names material {} of {}", part, m_materials.size()));
            sum += parts(part);
            take(m_materials[part], m);
        }
        if (sum > kMostParts) fail(m, fmt::format("has {} parts; allowed are {}", sum, kMostParts));
        return m_parts[index] = sum;
    }

  private:
    [[noreturn]] static void fail(const MaterialDescription& m, const std::string& what) {
        throw Error(Status::kInvalidScene, fmt::format("mixture '{}' {}", m.name, what));
    }
    // What a part has that is the whole surface's.
    static void take(const MaterialDescription& part, MaterialDescription& m) {
        if (isStretched(part) || part.kind == MaterialKind::kMixture)
            m.anisotropy = std::max(m.anisotropy, part.anisotropy);
        if (!isGlass(part)) return;
        if (m.hasGlass && (m.ior != part.ior || m.thinWalled != part.thinWalled))
            fail(m, "has parts of unlike glass: their index and thin walls have to be the same");
        m.hasGlass = true;
        m.ior = part.ior;
        m.thinWalled = part.thinWalled;
        m.priority = part.priority;
        m.attenuationColour = part.attenuationColour;
        m.attenuationDistance = part.attenuationDistance;
    }

    std::vector<MaterialDescription>& m_materials;
    std::vector<std::size_t> m_parts;  // 0: not known yet
    std::vector<bool> m_isOpen;
};

}  // namespace

void completeMixtures(std::vector<MaterialDescription>& materials) {
    const auto isOne = [](const auto& m) { return m.kind == MaterialKind::kMixture; };
    if (std::ranges::none_of(materials, isOne)) return;
    for (MaterialDescription& m : materials)
        if (isOne(m)) {
            m.anisotropy = 0.0f;
            m.thinWalled = m.hasGlass = false;
        }
    Completed completed(materials);
    for (std::uint32_t i = 0; i < materials.size(); ++i) completed.parts(i);
}

std::vector<MaterialTraits> traitsOf(std::span<const MaterialDescription> materials,
                                     const LobeRoles& roles) {
    std::vector<MaterialTraits> all(materials.size());
    std::vector<bool> isKnown(materials.size());
    const auto find = [&](const auto& self, std::uint32_t index) -> const MaterialTraits& {
        if (isKnown[index]) return all[index];
        const MaterialDescription& m = materials[index];
        if (m.kind == MaterialKind::kMixture) {
            // By a number, a part that has no share of it anywhere is none.
            const bool isEven = m.weightTexture == kNoTexture;
            const MaterialTraits a = self(self, isEven && m.weight >= 1.0f ? m.second : m.first);
            const MaterialTraits b = self(self, isEven && m.weight <= 0.0f ? m.first : m.second);
            all[index] = traitsOfMixture(m, a, b);
        } else {
            all[index] = traitsOfOne(m, roles);
        }
        isKnown[index] = true;
        return all[index];
    };
    for (std::uint32_t i = 0; i < materials.size(); ++i) find(find, i);
    return all;
}

}  // namespace pm
