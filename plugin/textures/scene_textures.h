// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "integrator/materials/texture_source.h"
#include "plugin/textures/texture.h"

namespace pm::plugin {

// The textures of one scene, numbered. Filled while the scene is built, then const.
class SceneTextures final : public TextureSource {
  public:
    SceneTextures() = default;
    // The same textures, no failures.
    SceneTextures(const SceneTextures& other) : m_textures(other.m_textures) {}
    SceneTextures& operator=(const SceneTextures&) = delete;

    // The number of a texture here, given on first sight; kNoTexture for null. One thread.
    std::int32_t add(const std::shared_ptr<const Texture>& texture);

    // In the order of their numbers.
    std::vector<const TexturePicture*> pictures() const;
    // Of one texture: its own, or those of its tiles.
    std::vector<const TexturePicture*> picturesOf(std::int32_t index) const;
    // Bytes of all their texels, of every level.
    std::uint64_t texelBytes() const;

    // Of all pictures, each file once; texels: of their finest levels.
    TextureReads reads() const;
    std::uint64_t texels() const;

    Texel lookUp(std::int32_t index, const TextureContext& at) const override;
    // By what the codes of the file are.
    Vec3f normalAt(std::int32_t index, const TextureContext& at) const override;
    Texel lookUpOfLight(std::int32_t index, Vec2f uv) const override;
    bool isBlackWithin(std::int32_t index, Vec2f lo, Vec2f hi) const override;
    BadTexels badTexels(std::int32_t index, const CancelCheck& cancel) const override;
    std::array<float, 2> extremes(std::int32_t index, const CancelCheck& cancel) const override;
    std::string name(std::int32_t index) const override;
    std::array<std::uint32_t, 2> texels(std::int32_t index) const override;
    std::uint64_t memoryBytes() const override;
    std::uint64_t failureCount() const override;

  private:
    // Those of different files.
    std::vector<const TexturePicture*> files() const;

    std::vector<std::shared_ptr<const Texture>> m_textures;
    mutable std::atomic<std::uint64_t> m_failures{0};
};

}  // namespace pm::plugin
