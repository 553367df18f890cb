// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <string_view>

#include "plugin/api/choice_reader.h"
#include "plugin/api/objects.h"
#include "plugin/api/parameter_tables.h"
#include "plugin/session/leave_behind.h"
#include "plugin/values/call_error.h"

namespace pm::plugin {

namespace {

// By PMR_WRAP_*.
constexpr std::array kWraps{Wrap::kRepeat, Wrap::kClamp, Wrap::kMirror, Wrap::kBlack};

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
    texture.wrapS = readChoice(desc.wrapS, kWraps, "PmrTextureDesc: wrapS", "PMR_WRAP_*");
    texture.wrapT = readChoice(desc.wrapT, kWraps, "PmrTextureDesc: wrapT", "PMR_WRAP_*");
    texture.uvScale = {orOne(checkedFinite(desc.uvScale[0], "uvScale[0]")),
                       orOne(checkedFinite(desc.uvScale[1], "uvScale[1]"))};
    texture.uvOffset = {checkedFinite(desc.uvOffset[0], "uvOffset[0]"),
                        checkedFinite(desc.uvOffset[1], "uvOffset[1]")};
    texture.gain = orOne(checkedFinite(desc.gain, "gain"));
    texture.base = checkedFinite(desc.base, "base");
    texture.texelHash = {desc.texelHash[0], desc.texelHash[1]};
    return texture;
}

Texture toTiles(const Context& context, const PmrTextureDesc& desc,
                const TextureDescription& whole) {
    if (desc.tiles == nullptr || desc.tileNumbers == nullptr)
        throw argumentError("PmrTextureDesc: tiles or tileNumbers is null");
    Texture texture{context.textures(), {}, {}};
    for (std::uint64_t i = 0; i < desc.tileCount; ++i) {
        const std::string member = fmt::format("PmrTextureDesc: tiles[{}]", i);
        const auto tile = findTexture(context, desc.tiles[i], member);
        const std::uint32_t number = desc.tileNumbers[i];
        if (!tile || !tile->tiles.empty())
            throw argumentError(member + " is null, or has tiles itself");
        if (number < 1001 || number > 9999)
            throw argumentError(fmt::format(
                "PmrTextureDesc: tileNumbers[{}] is {}; it must be 1001 to 9999", i, number));
        TexturePicture picture = tile->picture;
        picture.wrapS = picture.wrapT = Wrap::kClamp;
        picture.uvScale = whole.uvScale;
        picture.uvOffset = {whole.uvOffset.x - static_cast<float>((number - 1001) % 10),
                            whole.uvOffset.y - static_cast<float>((number - 1001) / 10)};
        picture.gain = whole.gain;
        picture.base = whole.base;
        texture.tiles.push_back({number, std::move(picture)});
    }
    std::ranges::sort(texture.tiles, {}, &TextureTile::number);
    if (std::ranges::adjacent_find(texture.tiles, {}, &TextureTile::number) != texture.tiles.end())
        throw argumentError("PmrTextureDesc: tileNumbers has one twice");
    const auto texels = [](const TextureTile& tile) {
        return std::uint64_t{tile.picture.width} * tile.picture.height;
    };
    texture.picture = std::ranges::max_element(texture.tiles, {}, texels)->picture;
    texture.picture.fileName = whole.fileName;
    texture.picture.uvOffset = whole.uvOffset;
    return texture;
}

}  // namespace

std::shared_ptr<TextureObject> makeTexture(std::shared_ptr<Context> context,
                                           const PmrTextureDesc& desc) {
    if (desc.tileCount > 0) {
        Texture tiles = toTiles(*context, desc, toTexture(desc));
        return std::make_shared<TextureObject>(std::move(context), std::move(tiles));
    }
    TexturePicture picture =
        runLeavable(context->buildCheck(), "opening a texture",
                    [textures = context->textures(), description = toTexture(desc)](
                        const CancelCheck&) { return textures->open(description); });
    return std::make_shared<TextureObject>(std::move(context), std::move(picture));
}

std::string MaterialObject::owner() const {
    return fmt::format("material '{}'", m_values.value("name").text);
}

bool MaterialObject::holds(const MaterialObject& other) const {
    const Parts parts = this->parts();
    return this == &other ||
           std::ranges::any_of(parts, [&](const auto& part) { return part && part->holds(other); });
}

std::shared_ptr<MaterialObject> MaterialObject::namedPart(const PmrParameterDesc& desc,
                                                          const std::string& owner) const {
    const std::string_view name = desc.name == nullptr ? "" : desc.name;
    if ((name != "first" && name != "second") || desc.text == nullptr) return nullptr;
    auto part = m_context->materialOfName(desc.text);
    if (!part)
        throw CallError(CallStatus::kName,
                        fmt::format("{}: {} is '{}', and no material of that name has been made",
                                    owner, name, desc.text));
    if (part->holds(*this))
        throw argumentError(fmt::format("{}: {} is '{}', so that it would be a part of itself",
                                        owner, name, desc.text));
    return part;
}

void MaterialObject::setParameter(const PmrParameterDesc& desc) {
    std::unique_lock lock(m_mutex);
    const std::string owner = this->owner();
    lock.unlock();  // a part may be asked whether it holds this
    auto part = namedPart(desc, owner);
    lock.lock();
    if (m_isUsed)
        throw CallError(CallStatus::kState,
                        owner + ": a scene uses it, so it can't change; an edit makes a new one");
    setByName(m_values, desc, *m_context, owner);
    if (part) m_parts[std::string_view(desc.name) == "first" ? 0 : 1] = std::move(part);
}

MaterialObject::Parts MaterialObject::parts() const {
    const std::lock_guard lock(m_mutex);
    return m_parts;
}

const MaterialSet& MaterialObject::use() {
    const std::lock_guard lock(m_mutex);
    m_isUsed = true;
    return m_values;
}

std::shared_ptr<MaterialObject> makeMaterial(std::shared_ptr<Context> context,
                                             const PmrMaterialDesc& desc) {
    if (desc.reserved != 0.0f) throw argumentError("PmrMaterialDesc: reserved must be 0");
    MaterialSet values(materialParameters());
    readStructInto(values, &desc, *context, "PmrMaterialDesc");
    values.check(0, fmt::format("material '{}'", values.value("name").text));
    const std::string name = values.value("name").text;
    auto material = std::make_shared<MaterialObject>(context, std::move(values));
    context->nameMaterial(name, material);
    return material;
}

}  // namespace pm::plugin
