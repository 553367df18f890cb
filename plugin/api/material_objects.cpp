// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include <fmt/format.h>

#include <cmath>
#include <string>
#include <string_view>

#include "plugin/api/entry.h"
#include "plugin/api/objects.h"
#include "plugin/session/leave_behind.h"
#include "plugin/values/call_error.h"

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

Wrap toWrap(std::int32_t wrap, const char* name) {
    switch (wrap) {
        case PMR_WRAP_REPEAT:
            return Wrap::kRepeat;
        case PMR_WRAP_CLAMP:
            return Wrap::kClamp;
        case PMR_WRAP_MIRROR:
            return Wrap::kMirror;
        case PMR_WRAP_BLACK:
            return Wrap::kBlack;
        default:
            throw argumentError(fmt::format(
                "PmrTextureDesc: {} is {}; it must be 0 to 3 (PMR_WRAP_*)", name, wrap));
    }
}

float checkedFinite(float value, const char* name) {
    if (!std::isfinite(value))
        throw argumentError(
            fmt::format("PmrTextureDesc: {} is {}; it must be finite", name, value));
    return value;
}

float orOne(float value) {
    return value == 0.0f ? 1.0f : value;
}

TextureDescription toTexture(const PmrTextureDesc& desc) {
    if (desc.fileName == nullptr || *desc.fileName == 0)
        throw argumentError("PmrTextureDesc: fileName is null or empty");
    TextureDescription texture;
    texture.fileName = desc.fileName;
    texture.wrapS = toWrap(desc.wrapS, "wrapS");
    texture.wrapT = toWrap(desc.wrapT, "wrapT");
    texture.uvScale = {orOne(checkedFinite(desc.uvScale[0], "uvScale[0]")),
                       orOne(checkedFinite(desc.uvScale[1], "uvScale[1]"))};
    texture.uvOffset = {checkedFinite(desc.uvOffset[0], "uvOffset[0]"),
                        checkedFinite(desc.uvOffset[1], "uvOffset[1]")};
    texture.gain = orOne(checkedFinite(desc.gain, "gain"));
    texture.base = checkedFinite(desc.base, "base");
    texture.texelHash = {desc.texelHash[0], desc.texelHash[1]};
    return texture;
}

std::shared_ptr<TextureObject> findTexture(const Context& context, PmrTexture handle,
                                           const char* member) {
    if (handle == nullptr) return nullptr;
    auto texture = findObject<TextureObject>(handle);
    if (!texture)
        throw CallError(CallStatus::kHandle,
                        fmt::format("PmrMaterialDesc: {} is not a live texture", member));
    if (texture->context().get() != &context)
        throw argumentError(fmt::format("PmrMaterialDesc: {} belongs to another context", member));
    return texture;
}

}  // namespace

std::shared_ptr<TextureObject> makeTexture(std::shared_ptr<Context> context,
                                           const PmrTextureDesc& desc) {
    TexturePicture picture =
        runLeavable(context->buildCheck(), "opening a texture",
                    [textures = context->textures(), description = toTexture(desc)](
                        const CancelCheck&) { return textures->open(description); });
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
