// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/render/material_builder.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <initializer_list>
#include <iterator>
#include <limits>
#include <utility>

#include "host_shim/process/interrupt.h"

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

using TextureOfKind = std::pair<const Boxed<TextureUse>*, TextureKind>;

std::vector<TextureOfKind> usesOf(const MaterialData& material) {
    std::vector<TextureOfKind> uses{{&material.diffuseTexture, TextureKind::kColour},
                                    {&material.glossyTexture, TextureKind::kColour},
                                    {&material.glossyExponentTexture, TextureKind::kData},
                                    {&material.roughnessTexture, TextureKind::kData},
                                    {&material.transmissionTexture, TextureKind::kColour},
                                    {&material.emissionTexture, TextureKind::kColour},
                                    {&material.opacityTexture, TextureKind::kMask},
                                    {&material.normalTexture, TextureKind::kVector},
                                    {&material.bumpTexture, TextureKind::kData},
                                    {&material.displacementTexture, TextureKind::kData},
                                    {&material.weightTexture, TextureKind::kData}};
    for (const MaterialData& part : material.parts)
        for (const TextureOfKind& use : usesOf(part)) uses.push_back(use);
    return uses;
}

TextureRequest requestOf(const TextureUse& use, const std::string& file, TextureKind kind) {
    return {file, kind, use.colourSpace, use.channel};
}

void addRequests(const TextureUse& use, TextureKind kind, std::vector<TextureRequest>& requests) {
    if (use.tiles.empty()) requests.push_back(requestOf(use, use.file, kind));
    for (const TileUse& tile : use.tiles) requests.push_back(requestOf(use, tile.file, kind));
}

}  // namespace

MaterialBuilder::MaterialBuilder(const PluginContext& context, const ColourPipeline& colour,
                                 MakePreparer textures, const WarningSink& warn)
    : m_context(context), m_colour(colour), m_makePreparer(std::move(textures)), m_warn(warn) {}

MaterialBuilder::~MaterialBuilder() {
    for (PmrMaterial material : m_materials) m_context.api().releaseMaterial(material);
    for (PmrTexture texture : m_textures) m_context.api().releaseTexture(texture);
}

TexturePreparer& MaterialBuilder::preparer() {
    if (!m_preparer) m_preparer.emplace(m_makePreparer());
    return *m_preparer;
}

TextureCounts MaterialBuilder::textureCounts() const {
    return m_preparer ? m_preparer->counts() : TextureCounts{};
}

void MaterialBuilder::prepare(const std::vector<const MaterialData*>& materials) {
    std::vector<TextureRequest> requests;
    for (const MaterialData* material : materials)
        for (const auto& [use, kind] : usesOf(*material))
            if (*use) addRequests(**use, kind, requests);
    if (!requests.empty()) preparer().prepare(requests);
}

// What a user should know of a picture, once.
void MaterialBuilder::tell(const std::string& file, const BakedTexture& baked) {
    const auto warn = [&](const std::string& text) {
        if (m_told.insert(text).second) m_warn(Warning::kTexture, text);
    };
    const BadTexelCount& bad = baked.facts.bad;
    if (bad.negative + bad.notFinite > 0)
        warn(
            fmt::format("{}: {} texels are below 0 and {} are infinite or not numbers; they are "
                        "taken as 0",
                        file, bad.negative, bad.notFinite));
    if (!baked.facts.note.empty()) warn(fmt::format("{}: {}", file, baked.facts.note));
    if (!baked.profile.empty() && baked.profile.find("sRGB") == std::string::npos)
        warn(
            fmt::format("{}: its colour profile '{}' is not obeyed; {} is taken (-colorspace, "
                        "--texture-space)",
                        file, baked.profile, baked.space.name));
}

PmrTexture MaterialBuilder::texture(const Boxed<TextureUse>& use, TextureKind kind,
                                    const std::string& of) {
    if (!use) return nullptr;
    return use->tiles.empty() ? picture(*use, use->file, kind, of) : tiles(*use, kind, of);
}

PmrTextureDesc MaterialBuilder::lookedUpAs(const TextureUse& use) {
    auto desc = PMR_INIT(PmrTextureDesc);
    desc.wrapS = desc.wrapT = use.clamp ? PMR_WRAP_CLAMP : PMR_WRAP_REPEAT;
    for (std::size_t i = 0; i < 2; ++i) {
        desc.uvScale[i] = use.scale[i];
        desc.uvOffset[i] = use.offset[i];
    }
    // 0 would count as 1.
    desc.gain = use.gain != 0 ? use.gain : std::numeric_limits<float>::min();
    desc.base = use.base;
    return desc;
}

// None, with a warning, where it can't be read.
std::optional<BakedTexture> MaterialBuilder::readable(const TextureUse& use,
                                                      const std::string& shown, TextureKind kind,
                                                      const std::string& of) {
    try {
        return preparer().texture(requestOf(use, shown, kind));
    } catch (const NotKept&) {
        throw;
    } catch (const HostError& error) {
        // Without it the memory limit would change the picture.
        if (error.code() == ExitCode::kMemory) throw;
        m_warn(Warning::kTexture, fmt::format("{}: {}: {}; {}", use.place, of, error.what(),
                                              withoutPicture(use.missing)));
        return std::nullopt;
    }
}

void MaterialBuilder::putOutLights(SceneData& data) {
    std::set<std::uint32_t> used;
    for (const InstanceData& instance : data.instances)
        for (const std::uint32_t material : data.materialsOf(instance)) used.insert(material);
    for (const std::uint32_t index : used) {
        MaterialData& material = data.materials[index];
        const Boxed<TextureUse>& use = material.emissionTexture;
        if (!use || !material.emits()) continue;
        const std::string of = "material " + material.name;
        bool isReadable = use->tiles.empty() && readable(*use, use->file, TextureKind::kColour, of);
        for (const TileUse& tile : use->tiles)
            if (readable(*use, tile.file, TextureKind::kColour, of)) isReadable = true;
        if (isReadable) continue;
        material.emission = {};
        material.emissionTexture.reset();
    }
}

PmrTexture MaterialBuilder::wantedTexture(const TextureUse& use, TextureKind kind) {
    try {
        return make(use, preparer().texture(requestOf(use, use.file, kind)), use.file);
    } catch (const NotKept&) {
        throw;
    } catch (const HostError& error) {
        throw HostError(error.code(), fmt::format("{}: {}", use.place, error.what()));
    }
}

PmrTexture MaterialBuilder::picture(const TextureUse& use, const std::string& shown,
                                    TextureKind kind, const std::string& of) {
    const auto baked = readable(use, shown, kind, of);
    return baked ? make(use, *baked, shown) : nullptr;
}

PmrTexture MaterialBuilder::make(const TextureUse& use, const BakedTexture& baked,
                                 const std::string& shown) {
    tell(shown, baked);
    const std::string file = baked.file.string();
    m_preparedFiles.emplace(file, shown);
    PmrTextureDesc desc = lookedUpAs(use);
    desc.fileName = file.c_str();
    std::ranges::copy(baked.facts.texelHash, desc.texelHash);
    return make(desc, shown);
}

PmrTexture MaterialBuilder::tiles(const TextureUse& use, TextureKind kind, const std::string& of) {
    std::vector<PmrTexture> pictures;
    std::vector<std::uint32_t> numbers;
    for (const TileUse& tile : use.tiles)
        if (const PmrTexture one = picture(use, tile.file, kind, of)) {
            pictures.push_back(one);
            numbers.push_back(tile.number);
        }
    if (pictures.empty()) return nullptr;
    PmrTextureDesc desc = lookedUpAs(use);
    desc.fileName = use.file.c_str();
    desc.tiles = pictures.data();
    desc.tileNumbers = numbers.data();
    desc.tileCount = pictures.size();
    return make(desc, use.file);
}

// The first of its files of which that is so; empty where it is of none.
std::string MaterialBuilder::firstWith(bool TextureFacts::*fact, const TextureUse& use,
                                       TextureKind kind) {
    std::vector<TextureRequest> requests;
    addRequests(use, kind, requests);
    for (const TextureRequest& request : requests) {
        try {
            if (preparer().texture(request).facts.*fact) return request.file.string();
        } catch (const HostError&) {
            continue;  // one that is told already
        }
    }
    return {};
}

// Heights that are the picture of something else, once a material.
void MaterialBuilder::tellNormals(const TextureUse& use, const std::string& of) {
    const std::string file = firstWith(&TextureFacts::isLikeNormals, use, TextureKind::kData);
    if (file.empty()) return;
    m_warn(Warning::kTexture,
           fmt::format("{}: {}: {} looks like a normal map and is taken as heights; in MTL a "
                       "normal map is called norm, and --bump-is-normal takes bump maps as such",
                       use.place, of, file));
}

std::vector<const MaterialData*> MaterialBuilder::cutUnasked(
    const std::vector<const MaterialData*>& materials) {
    std::vector<const MaterialData*> cut;
    std::ranges::copy_if(materials, std::back_inserter(cut), [](const MaterialData* material) {
        return material->diffuseTexture && !material->opacityTexture;
    });
    prepare(cut);
    std::erase_if(cut, [this](const MaterialData* material) {
        return firstWith(&TextureFacts::isCutOut, *material->diffuseTexture, TextureKind::kColour)
            .empty();
    });
    return cut;
}

// A picture that says where it is to be seen through, of a material that doesn't ask for that.
void MaterialBuilder::tellAlpha(const TextureUse& use, const std::string& of) {
    const std::string file = firstWith(&TextureFacts::hasHoles, use, TextureKind::kColour);
    if (file.empty() || !m_told.insert("alpha " + file).second) return;
    m_warn(Warning::kTexture,
           fmt::format("{}: {}: {} has texels that are to be seen through, which are shown as "
                       "surface, as there is no map_d; --alpha-of-pictures takes its alpha as "
                       "map_d",
                       use.place, of, file));
}

PmrTexture MaterialBuilder::make(const PmrTextureDesc& desc, const std::string& shown) {
    PmrTexture texture = nullptr;
    m_context.check(m_context.api().createTexture(m_context.handle(), &desc, &texture), shown);
    m_textures.push_back(texture);
    return texture;
}

void MaterialBuilder::convertColours(const MaterialData& material, PmrMaterialDesc& desc) const {
    store(m_colour.materialToRendering(material.diffuse), 1.0f, desc.diffuse);
    store(m_colour.materialToRendering(material.glossy), 1.0f, desc.glossy);
    store(m_colour.materialToRendering(material.transmission), 1.0f, desc.transmission);
    store(m_colour.materialToRendering(material.emission), std::numeric_limits<float>::max(),
          desc.emission);
    // What is below a coat of facets gets no more than that leaves.
    if (material.roughness > 0) return;
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
    for (const MaterialData& part : material.parts) build(part);
    auto desc = PMR_INIT(PmrMaterialDesc);
    desc.name = material.name.c_str();
    desc.kind = material.parts.empty() ? kindOf(material.kind) : PMR_MATERIAL_MIXTURE;
    desc.fresnel = material.fresnel ? 1 : 0;
    desc.glossyExponent = material.glossyExponent;
    desc.ior = material.ior;
    desc.transparency = material.transparency;
    convertColours(material, desc);
    const std::string of = "material " + material.name;
    const auto colourOf = [&](const Boxed<TextureUse>& use, float(&number)[3]) {
        const PmrTexture made = texture(use, TextureKind::kColour, of);
        if (use && made == nullptr)
            for (float& channel : number) channel = std::min(1.0f, channel * use->missing);
        return made;
    };
    desc.diffuseTexture = colourOf(material.diffuseTexture, desc.diffuse);
    if (material.diffuseTexture && !material.opacityTexture)
        tellAlpha(*material.diffuseTexture, of);
    desc.glossyTexture = colourOf(material.glossyTexture, desc.glossy);
    desc.glossyExponentTexture = texture(material.glossyExponentTexture, TextureKind::kData, of);
    desc.transmissionTexture = colourOf(material.transmissionTexture, desc.transmission);
    desc.emissionTexture = texture(material.emissionTexture, TextureKind::kColour, of);
    desc.opacityTexture = texture(material.opacityTexture, TextureKind::kMask, of);
    PmrMaterial handle = nullptr;
    m_context.check(m_context.api().createMaterial(m_context.handle(), &desc, &handle), of);
    m_materials.push_back(handle);
    setByName(material, handle, of);
    setMixture(material, handle, of);
    for (const NamedValue& value : material.byName) setNamed(value, handle);
    return handle;
}

void MaterialBuilder::setMixture(const MaterialData& material, PmrMaterial handle,
                                 const std::string& of) {
    auto desc = PMR_INIT(PmrParameterDesc);
    desc.object = PMR_OBJECT_MATERIAL;
    desc.material = handle;
    const auto set = [&] { m_context.check(m_context.api().setParameter(&desc), of); };
    for (std::size_t i = 0; i < material.parts.size(); ++i) {
        desc.name = i == 0 ? "first" : "second";
        desc.text = material.parts[i].name.c_str();
        set();
    }
    desc.text = nullptr;
    desc.texture = texture(material.weightTexture, TextureKind::kData, of);
    if (desc.texture != nullptr) {
        desc.name = "weightTexture";
        set();
    }
    if (material.parts.empty()) return;
    const bool isLost = material.weightTexture && desc.texture == nullptr;
    const double weight = static_cast<double>(material.weight) *
                          (isLost ? static_cast<double>(material.weightTexture->missing) : 1);
    desc.texture = nullptr;
    desc.name = "weight";
    desc.numbers = &weight;
    desc.numberCount = 1;
    set();
}

// What is in no struct is set by name.
void MaterialBuilder::setByName(const MaterialData& material, PmrMaterial handle,
                                const std::string& of) {
    auto desc = PMR_INIT(PmrParameterDesc);
    desc.object = PMR_OBJECT_MATERIAL;
    desc.material = handle;
    const auto setNumbers = [&](const char* name, std::initializer_list<double> numbers) {
        PmrParameterDesc own = desc;
        own.name = name;
        own.numbers = numbers.begin();
        own.numberCount = static_cast<std::uint32_t>(numbers.size());
        m_context.check(m_context.api().setParameter(&own), of);
    };
    const auto setNumber = [&](const char* name, float number) {
        setNumbers(name, {static_cast<double>(number)});
    };
    const auto setTexture = [&](const char* name, const Boxed<TextureUse>& use, TextureKind kind) {
        PmrParameterDesc own = desc;
        own.name = name;
        own.texture = texture(use, kind, of);
        if (own.texture != nullptr) m_context.check(m_context.api().setParameter(&own), of);
        return own.texture != nullptr;
    };
    if (material.roughness > 0) {
        const bool hasPicture =
            setTexture("roughnessTexture", material.roughnessTexture, TextureKind::kData);
        const bool isLost = material.roughnessTexture && !hasPicture;
        setNumber("roughness",
                  material.roughness * (isLost ? material.roughnessTexture->missing : 1));
    }
    if (setTexture("normalTexture", material.normalTexture, TextureKind::kVector))
        setNumber("normalScale", material.normalTexture->strength);
    if (setTexture("bumpTexture", material.bumpTexture, TextureKind::kData)) {
        setNumber("bumpScale", material.bumpTexture->strength);
        tellNormals(*material.bumpTexture, of);
    }
    if (setTexture("displacementTexture", material.displacementTexture, TextureKind::kData))
        setNumber("displacementScale", material.displacementTexture->strength);
    if (material.coat > 0) {
        setNumber("coat", material.coat);
        setNumber("coatRoughness", material.coatRoughness);
    }
    if (material.anisotropy > 0) {
        setNumber("anisotropy", material.anisotropy);
        setNumber("anisotropyRotation", material.anisotropyRotation);
    }
    if (material.sheen == std::array<float, 3>{}) return;
    float sheen[3];
    store(m_colour.materialToRendering(material.sheen), 1.0f, sheen);
    setNumbers("sheen", {static_cast<double>(sheen[0]), static_cast<double>(sheen[1]),
                         static_cast<double>(sheen[2])});
    setNumber("sheenRoughness", material.sheenRoughness);
}

void MaterialBuilder::setNamed(const NamedValue& value, PmrMaterial handle) {
    constexpr std::array kColours = {
        "diffuse", "glossy",   "transmission",     "emission", "diffuseTransmission",
        "sheen",   "edgeTint", "attenuationColour"};
    constexpr std::array kOfChannels = {"conductorN", "conductorK"};
    const auto isAmong = [&](const auto& names) {
        return std::ranges::find(names, value.name) != names.end();
    };
    std::vector<double> numbers = value.numbers;
    // One number is grey.
    if (numbers.size() == 1 && (isAmong(kColours) || isAmong(kOfChannels)))
        numbers.assign(3, value.numbers.front());
    if (numbers.size() == 3 && isAmong(kColours)) {
        const Rgb3 colour = m_colour.materialToRendering({static_cast<float>(numbers[0]),
                                                          static_cast<float>(numbers[1]),
                                                          static_cast<float>(numbers[2])});
        // Saturated colours may leave the range by the conversion; what was outside is refused.
        for (std::size_t i = 0; i < 3; ++i)
            if (numbers[i] >= 0)
                numbers[i] = std::clamp(static_cast<double>(colour[i]), 0.0,
                                        numbers[i] <= 1 && value.name != "emission"
                                            ? 1.0
                                            : std::numeric_limits<double>::max());
    }
    auto desc = PMR_INIT(PmrParameterDesc);
    desc.object = PMR_OBJECT_MATERIAL;
    desc.material = handle;
    desc.name = value.name.c_str();
    desc.numbers = numbers.data();
    desc.numberCount = numbers.size();
    if (!value.text.empty()) desc.text = value.text.c_str();
    m_context.check(m_context.api().setParameter(&desc), value.place);
}

}  // namespace pm::host
