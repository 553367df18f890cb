// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include <fmt/format.h>

#include <cmath>
#include <string>
#include <string_view>

#include "plugin/src/call_error.h"
#include "plugin/src/entry.h"
#include "plugin/src/leave_behind.h"
#include "plugin/src/objects.h"

namespace pm::plugin {

namespace {

// Checks the members of one material; errors name it.
class MaterialChecker {
  public:
    explicit MaterialChecker(std::string_view name) : m_name(name) {}

    CallError refuse(std::string_view member, float value, std::string_view allowed) const {
        return argumentError(
            fmt::format("material '{}': {} is {}; it must be {}", m_name, member, value, allowed));
    }

    float inRange(float value, float minimum, float maximum, std::string_view member,
                  std::string_view allowed) const {
        if (!(value >= minimum && value <= maximum)) throw refuse(member, value, allowed);
        return value;
    }

    Rgb reflectance(const float (&values)[3], std::string_view member) const {
        for (const float value : values) inRange(value, 0.0f, 1.0f, member, "0 to 1");
        return {values[0], values[1], values[2]};
    }

    Rgb radiance(const float (&values)[3], std::string_view member) const {
        for (const float value : values)
            inRange(value, 0.0f, kMaxFloat, member, "0 or more and finite (W m^-2 sr^-1)");
        return {values[0], values[1], values[2]};
    }

    float nonNegative(float value, std::string_view member) const {
        return inRange(value, 0.0f, kMaxFloat, member, "0 or more and finite");
    }

  private:
    static constexpr float kMaxFloat = 3.402823466e38f;
    std::string_view m_name;
};

MaterialKind toKind(std::int32_t kind, std::string_view name) {
    switch (kind) {
        case PMR_MATERIAL_SURFACE:
            return MaterialKind::kSurface;
        case PMR_MATERIAL_MIRROR:
            return MaterialKind::kMirror;
        case PMR_MATERIAL_DIELECTRIC:
            return MaterialKind::kDielectric;
        default:
            throw argumentError(fmt::format(
                "material '{}': kind is {}; it must be 0 to 2 (PMR_MATERIAL_*)", name, kind));
    }
}

MaterialDescription toDescription(const PmrMaterialDesc& desc) {
    MaterialDescription material;
    material.name = desc.name == nullptr ? "" : desc.name;
    const MaterialChecker check(material.name);
    material.kind = toKind(desc.kind, material.name);
    if (desc.fresnel != 0 && desc.fresnel != 1)
        throw argumentError(fmt::format("material '{}': fresnel is {}; it must be 0 or 1",
                                        material.name, desc.fresnel));
    if (desc.reserved != 0.0f) throw argumentError("PmrMaterialDesc: reserved must be 0");
    material.fresnelMirror = desc.fresnel == 1;
    material.diffuse = check.reflectance(desc.diffuse, "diffuse");
    material.glossy = check.reflectance(desc.glossy, "glossy");
    material.glossyExponent = check.nonNegative(desc.glossyExponent, "glossyExponent");
    material.ior = check.nonNegative(desc.ior, "ior");
    if (material.ior == 0.0f) material.ior = 1.5f;
    material.transmission = check.reflectance(desc.transmission, "transmission");
    material.emission = check.radiance(desc.emission, "emission");
    material.transparency = check.inRange(desc.transparency, 0.0f, 1.0f, "transparency", "0 to 1");
    return material;
}

std::shared_ptr<TextureObject> findTexture(const Context& context, PmrTexture handle,
                                           const char* member) {
    if (handle == nullptr) return nullptr;
    auto texture = findObject<TextureObject>(handle);
    if (!texture)
        throw CallError(PMR_ERROR_HANDLE,
                        fmt::format("PmrMaterialDesc: {} is not a live texture", member));
    if (texture->context().get() != &context)
        throw argumentError(fmt::format("PmrMaterialDesc: {} belongs to another context", member));
    return texture;
}

}  // namespace

std::shared_ptr<TextureObject> makeTexture(std::shared_ptr<Context> context,
                                           const PmrTextureDesc& desc) {
    TexturePicture picture = runLeavable(
        context->buildCheck(), "opening a texture",
        [context, owned = desc, name = std::string(desc.fileName == nullptr ? "" : desc.fileName)](
            const CancelCheck&) mutable {
            owned.fileName = name.c_str();
            return context->textures().open(owned);
        });
    return std::make_shared<TextureObject>(std::move(context), std::move(picture));
}

std::shared_ptr<MaterialObject> makeMaterial(std::shared_ptr<Context> context,
                                             const PmrMaterialDesc& desc) {
    MaterialDescription description = toDescription(desc);
    MaterialTextures textures = {
        findTexture(*context, desc.diffuseTexture, "diffuseTexture"),
        findTexture(*context, desc.glossyTexture, "glossyTexture"),
        findTexture(*context, desc.glossyExponentTexture, "glossyExponentTexture"),
        findTexture(*context, desc.transmissionTexture, "transmissionTexture"),
        findTexture(*context, desc.emissionTexture, "emissionTexture"),
        findTexture(*context, desc.opacityTexture, "opacityTexture"),
    };
    return std::make_shared<MaterialObject>(std::move(context), std::move(description),
                                            std::move(textures));
}

}  // namespace pm::plugin
