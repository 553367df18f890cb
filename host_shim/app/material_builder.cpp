// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/app/material_builder.h"

#include "host_shim/app/interrupt.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

namespace pm::host {
namespace {

int32_t kindOf(MaterialKind kind) {
    switch (kind) {
        case MaterialKind::kMirror:
            return PMR_MATERIAL_MIRROR;
        case MaterialKind::kDielectric:
            return PMR_MATERIAL_DIELECTRIC;
        default:
            return PMR_MATERIAL_SURFACE;
    }
}

// Between spaces a saturated colour may leave [0,1]; the plugin takes none that does.
void store(const Rgb3& colour, float largest, float (&target)[3]) {
    for (std::size_t i = 0; i < 3; ++i) target[i] = std::clamp(colour[i], 0.0f, largest);
}

}  // namespace

MaterialBuilder::MaterialBuilder(const PluginContext& context, const ColourPipeline& colour,
                                 TemporaryFolder& folder, const WarningSink& warn)
    : m_context(context), m_colour(colour), m_folder(folder), m_warn(warn) {}

MaterialBuilder::~MaterialBuilder() {
    for (PmrMaterial material : m_materials) m_context.api().releaseMaterial(material);
    for (PmrTexture texture : m_textures) m_context.api().releaseTexture(texture);
}

PmrTexture MaterialBuilder::texture(const std::optional<TextureUse>& use,
                                    const std::string& material) {
    if (!use) return nullptr;
    if (!m_baker) m_baker.emplace(m_colour, m_folder.path(), throwIfInterrupted);
    std::string file;
    try {
        const auto kind = use->isData ? TextureKind::kData : TextureKind::kColour;
        const BakedTexture& baked = m_baker->bake({use->file, kind, use->colourSpace, use->clamp});
        file = baked.file.string();
        if (baked.badTexels > 0) {
            m_warn(Warning::kTexture,
                   fmt::format("{}: {} texels were not finite and are taken as 0", use->file,
                               baked.badTexels));
        }
    } catch (const HostError& error) {
        m_warn(Warning::kTexture, fmt::format("{}: material {}: {}; its number is used alone",
                                              use->place, material, error.what()));
        return nullptr;
    }
    auto desc = PMR_INIT(PmrTextureDesc);
    desc.fileName = file.c_str();
    desc.wrapS = desc.wrapT = use->clamp ? PMR_WRAP_CLAMP : PMR_WRAP_REPEAT;
    for (std::size_t i = 0; i < 2; ++i) {
        desc.uvScale[i] = use->scale[i];
        desc.uvOffset[i] = use->offset[i];
    }
    // 0 would count as 1.
    desc.gain = use->gain != 0 ? use->gain : std::numeric_limits<float>::min();
    desc.base = use->base;
    PmrTexture texture = nullptr;
    m_context.check(m_context.api().createTexture(m_context.handle(), &desc, &texture), use->file);
    m_textures.push_back(texture);
    return texture;
}

void MaterialBuilder::convertColours(const MaterialData& material, PmrMaterialDesc& desc) const {
    store(m_colour.materialToRendering(material.diffuse), 1.0f, desc.diffuse);
    store(m_colour.materialToRendering(material.glossy), 1.0f, desc.glossy);
    store(m_colour.materialToRendering(material.transmission), 1.0f, desc.transmission);
    store(m_colour.materialToRendering(material.emission), std::numeric_limits<float>::max(),
          desc.emission);
    // In the other space a channel's sum may have passed 1.
    float largest = 1.0f;
    for (std::size_t i = 0; i < 3; ++i) {
        largest = std::max(largest, desc.diffuse[i] + desc.glossy[i]);
    }
    for (std::size_t i = 0; i < 3; ++i) {
        desc.diffuse[i] /= largest;
        desc.glossy[i] /= largest;
    }
}

PmrMaterial MaterialBuilder::build(const MaterialData& material) {
    auto desc = PMR_INIT(PmrMaterialDesc);
    desc.name = material.name.c_str();
    desc.kind = kindOf(material.kind);
    desc.fresnel = material.fresnel ? 1 : 0;
    desc.glossyExponent = material.glossyExponent;
    desc.ior = material.ior;
    desc.transparency = material.transparency;
    convertColours(material, desc);
    desc.diffuseTexture = texture(material.diffuseTexture, material.name);
    desc.glossyTexture = texture(material.glossyTexture, material.name);
    desc.glossyExponentTexture = texture(material.glossyExponentTexture, material.name);
    desc.transmissionTexture = texture(material.transmissionTexture, material.name);
    desc.emissionTexture = texture(material.emissionTexture, material.name);
    desc.opacityTexture = texture(material.opacityTexture, material.name);
    PmrMaterial handle = nullptr;
    m_context.check(m_context.api().createMaterial(m_context.handle(), &desc, &handle),
                    fmt::format("material {}", material.name));
    m_materials.push_back(handle);
    return handle;
}

}  // namespace pm::host
