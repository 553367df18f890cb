// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "integrator/geometry/limit_surface.h"
#include "integrator/geometry/subdivision.h"

namespace pm {

// A cage that is kept, to be tessellated part by part where and when it is needed. Constant.
// Threads: const functions from any.
class LimitShape {
  public:
    static constexpr std::uint32_t kNone = 0xffffffffu;

    // A face, and the corner of it where an edge begins or a vertex is.
    struct Owner {
        std::uint32_t face = kNone;
        std::uint16_t corner = 0;  // below kMaxFaceSize
        bool forwards = true;      // whether it runs along the edge in the edge's own direction
    };

    // rate: pieces of an edge where nothing else decides, 1 to kMaxTessellationRate. Errors:
    // validate(cage); kInvalidScene for what OpenSubdiv rejects.
    LimitShape(SubdivisionCage cage, int rate);

    const SubdivisionCage& cage() const { return m_cage; }
    const LimitSurface& surface() const { return *m_surface; }
    int rate() const { return m_rate; }

    // The first face that has an edge or vertex and a surface: it alone says where their points
    // are.
    Owner ownerOfEdge(std::uint32_t edge) const { return m_ofEdges[edge]; }
    Owner ownerOfVertex(std::uint32_t vertex) const { return m_ofVertices[vertex]; }
    // The most pieces that the edge may be cut into, by the faces that have it.
    int mostPieces(std::uint32_t edge) const { return m_mostPieces[edge]; }

    // Of the cage with what OpenSubdiv makes of it; an estimate.
    std::uint64_t memoryBytes() const;

  private:
    SubdivisionCage m_cage;
    int m_rate;
    std::unique_ptr<const LimitSurface> m_surface;
    std::vector<Owner> m_ofEdges, m_ofVertices;
    std::vector<std::uint16_t> m_mostPieces;
};

}  // namespace pm
