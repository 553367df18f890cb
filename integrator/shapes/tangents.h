// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "integrator/geometry/polygon_mesh.h"
#include "integrator/values/cancel_check.h"
#include "integrator/values/vec.h"

namespace pm {

// The tangents of a mesh with texture coordinates, at the corners of its triangles, in its own
// space: those that programs bake normal maps against, known as MikkTSpace (Mikkelsen, "Simulation
// of Wrinkled Surfaces Revisited", 2008). Corners are one where position, normal and texture
// coordinate are the same, triangles around it share edges and their texture coordinates run the
// same way round; there the directions in which u grows, at right angles to the normal, are
// averaged by the triangles' angles. A mesh without normals has those of its triangles.
class Tangents {
  public:
    // mesh: with texture coordinates. Throws Error(kCancelled) soon after cancel is set.
    explicit Tangents(const TriangleMesh& mesh, const CancelCheck& cancel = {});

    // Those of a mesh, made the first time that they are asked for. Threads: any.
    static std::shared_ptr<const Tangents> of(const TriangleMesh& mesh,
                                              const CancelCheck& cancel = {});

    // Unit, at right angles to the corner's normal; 0 where the texture coordinates of no triangle
    // around have an area.
    const Vec3f& at(std::uint32_t triangle, std::size_t corner) const {
        return m_tangents[m_indices[triangle][corner]];
    }
    // Whether u, v and the triangle's front are a left-handed system: the bitangent is minus the
    // cross product of normal and tangent.
    bool isMirrored(std::uint32_t triangle) const { return m_isMirrored[triangle]; }

    std::uint64_t memoryBytes() const {
        return m_tangents.size() * sizeof(Vec3f) +
               m_indices.size() * sizeof(TriangleMesh::Corners) + m_isMirrored.size() / 8;
    }

  private:
    std::vector<Vec3f> m_tangents;  // the first is 0
    std::vector<TriangleMesh::Corners> m_indices;
    std::vector<bool> m_isMirrored;
};

}  // namespace pm
