// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "plugin/textures/scene_textures.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <string_view>

namespace pm::plugin {

std::int32_t SceneTextures::add(const std::shared_ptr<const Texture>& texture) {
    if (!texture) return kNoTexture;
    const auto found = std::find(m_textures.begin(), m_textures.end(), texture);
    const auto index = static_cast<std::int32_t>(found - m_textures.begin());
    if (found == m_textures.end()) m_textures.push_back(texture);
    return index;
}

std::vector<const TexturePicture*> SceneTextures::pictures() const {
    std::vector<const TexturePicture*> pictures;
    for (std::size_t i = 0; i < m_textures.size(); ++i)
        for (const TexturePicture* picture : picturesOf(static_cast<std::int32_t>(i)))
            pictures.push_back(picture);
    return pictures;
}

std::vector<const TexturePicture*> SceneTextures::picturesOf(std::int32_t index) const {
    const Texture& texture = *m_textures[static_cast<std::size_t>(index)];
    if (texture.tiles.empty()) return {&texture.picture};
    std::vector<const TexturePicture*> pictures;
    for (const TextureTile& tile : texture.tiles) pictures.push_back(&tile.picture);
    return pictures;
}

std::uint64_t SceneTextures::texelBytes() const {
    std::uint64_t bytes = 0;
    for (const TexturePicture* picture : pictures())
        bytes += std::uint64_t{picture->width} * picture->height *
                 static_cast<std::uint64_t>(picture->channelCount) * sizeof(float);
    return bytes + bytes / 3;
}

std::uint64_t SceneTextures::memoryBytes() const {
    // OpenImageIO's record of a file and its levels: 15 KiB were measured of 64 x 64 texels.
    constexpr std::uint64_t kRecordBytes = std::uint64_t{20} << 10;
    std::set<std::string_view> names;
    for (const TexturePicture* picture : pictures()) names.insert(picture->fileName);
    return names.size() * kRecordBytes;
}

std::vector<const TexturePicture*> SceneTextures::files() const {
    std::vector<const TexturePicture*> files;
    for (const TexturePicture* const picture : pictures())
        if (std::ranges::none_of(files, [&](const TexturePicture* other) {
                return other->fileName == picture->fileName;
            }))
            files.push_back(picture);
    return files;
}

TextureReads SceneTextures::reads() const {
    TextureReads sum;
    // All of a scene are of one context, and so of one cache.
    for (const TexturePicture* picture : files()) sum += m_textures[0]->system->reads(*picture);
    return sum;
}

std::uint64_t SceneTextures::texels() const {
    std::uint64_t sum = 0;
    for (const TexturePicture* picture : files())
        sum += std::uint64_t{picture->width} * picture->height;
    return sum;
}

Texel SceneTextures::lookUp(std::int32_t index, const TextureContext& at) const {
    Texel texel;
    const Texture& texture = *m_textures[static_cast<std::size_t>(index)];
    const TexturePicture* const picture = texture.at(at.uv);
    if (picture && !texture.system->lookUp(*picture, at.uv, at.footprint, texel))
        m_failures.fetch_add(1, std::memory_order_relaxed);
    return texel;
}

Vec3f SceneTextures::normalAt(std::int32_t index, const TextureContext& at) const {
    const Texel texel = lookUp(index, at);
    const TexturePicture* const picture = m_textures[static_cast<std::size_t>(index)]->at(at.uv);
    const float largestCode = picture ? picture->largestCode : 1.0f;
    return {decodedNormal(texel.r, largestCode), decodedNormal(texel.g, largestCode),
            decodedNormal(texel.b, largestCode)};
}

Texel SceneTextures::lookUpOfLight(std::int32_t index, Vec2f uv) const {
    Texel texel;
    const Texture& texture = *m_textures[static_cast<std::size_t>(index)];
    const TexturePicture* const picture = texture.at(uv);
    if (picture && !texture.system->lookUpOfLight(*picture, uv, texel))
        m_failures.fetch_add(1, std::memory_order_relaxed);
    return texel;
}

bool SceneTextures::isBlackWithin(std::int32_t index, Vec2f lo, Vec2f hi) const {
    const Texture& texture = *m_textures[static_cast<std::size_t>(index)];
    const TexturePicture* const picture = texture.at(lo);
    return picture && picture == texture.at(hi) && texture.system->isBlackWithin(*picture, lo, hi);
}

BadTexels SceneTextures::badTexels(std::int32_t index, const CancelCheck& cancel) const {
    const Texture& texture = *m_textures[static_cast<std::size_t>(index)];
    if (texture.tiles.empty()) return texture.system->badTexels(texture.picture, cancel);
    BadTexels bad;
    for (const TextureTile& tile : texture.tiles) {
        const BadTexels of = texture.system->badTexels(tile.picture, cancel);
        bad.negative += of.negative;
        bad.notFinite += of.notFinite;
    }
    return bad;
}

std::array<float, 2> SceneTextures::extremes(std::int32_t index, const CancelCheck& cancel) const {
    const Texture& texture = *m_textures[static_cast<std::size_t>(index)];
    if (texture.tiles.empty()) return texture.system->extremes(texture.picture, cancel);
    // Where there is no tile the texel is 0.
    std::array<float, 2> all{0.0f, 0.0f};
    for (const TextureTile& tile : texture.tiles) {
        const auto [lo, hi] = texture.system->extremes(tile.picture, cancel);
        all = {std::min(all[0], lo), std::max(all[1], hi)};
    }
    return all;
}

std::string SceneTextures::name(std::int32_t index) const {
    const std::string& file = m_textures[static_cast<std::size_t>(index)]->picture.fileName;
    return file.substr(file.find_last_of('/') + 1);
}

std::array<std::uint32_t, 2> SceneTextures::texels(std::int32_t index) const {
    const TexturePicture& picture = m_textures[static_cast<std::size_t>(index)]->picture;
    const auto over = [](std::uint32_t texels, float scale) {
        return static_cast<std::uint32_t>(std::clamp(
            std::ceil(static_cast<double>(texels) * std::abs(static_cast<double>(scale))), 1.0,
            1e6));
    };
    return {over(picture.width, picture.uvScale.x), over(picture.height, picture.uvScale.y)};
}

std::uint64_t SceneTextures::failureCount() const {
    return m_failures.load(std::memory_order_relaxed);
}

}  // namespace pm::plugin
