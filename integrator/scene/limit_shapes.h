// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// What a scene says to the limit surfaces in it that are cut on demand: how finely, and where
// their points are displaced to.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "integrator/scene/scene_description.h"
#include "integrator/tessellation/edge_rates.h"
#include "integrator/tessellation/height_field.h"
#include "integrator/tessellation/limit_groups.h"
#include "integrator/values/box.h"
#include "integrator/values/cancel_check.h"

namespace pm {

// Heights that a material's texture shows, at its finest level.
class TextureHeights final : public HeightField {
  public:
    // textures: must outlive it. Throws Error(kCancelled).
    TextureHeights(const TextureSource& textures, const MaterialDescription& material,
                   const CancelCheck& cancel);
    double at(const std::array<double, 2>& texcoord) const override;
    std::array<double, 2> range() const override { return m_range; }

  private:
    const TextureSource& m_textures;
    std::int32_t m_texture;
    double m_scale;
    std::array<double, 2> m_range;
};

// All triangles of the groups, in the scene's own coordinates. isMirrored: the transform to there
// turns the winding round; the mesh's fronts are out as the groups' are. Throws Error(kCancelled).
TriangleMesh meshOf(const LimitGroups& groups, bool isMirrored, const CancelCheck& cancel);

// A box that holds a shape, world space: its cage's, and as much as its materials may displace.
Box3d boxAround(const LimitShape& shape, const Transform& transform, double highest);

// centre: of the scene, world.
TessellationRule ruleOf(const SceneDescription& description, const InstanceDescription& instance,
                        const Vec3d& centre);

}  // namespace pm
