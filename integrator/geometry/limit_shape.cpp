// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/geometry/limit_shape.h"

#include <algorithm>
#include <utility>

#include "integrator/geometry/face_pattern.h"

namespace pm {

LimitShape::LimitShape(SubdivisionCage cage, int rate) : m_cage(std::move(cage)), m_rate(rate) {
    validate(m_cage);
    m_surface = std::make_unique<const LimitSurface>(m_cage);
    m_ofVertices.resize(m_cage.mesh.positions.size());
    m_ofEdges.resize(m_surface->edgeCount());
    m_mostPieces.assign(m_surface->edgeCount(), kMostPieces);
    std::vector<LimitSurface::FaceCorner> corners;
    for (std::uint32_t face = 0; face < m_cage.mesh.faceCount(); ++face) {
        if (!m_surface->hasSurface(face)) continue;
        m_surface->listCorners(face, corners);
        const auto most = static_cast<std::uint16_t>(
            pm::mostPieces(m_cage.scheme, static_cast<std::uint32_t>(corners.size())));
        for (std::uint16_t i = 0; i < corners.size(); ++i) {
            Owner& ofVertex = m_ofVertices[corners[i].vertex];
            if (ofVertex.face == kNone) ofVertex = {face, i, true};
            Owner& ofEdge = m_ofEdges[corners[i].edge];
            if (ofEdge.face == kNone) ofEdge = {face, i, corners[i].forwards};
            std::uint16_t& pieces = m_mostPieces[corners[i].edge];
            pieces = std::min(pieces, most);
        }
    }
}

std::uint64_t LimitShape::memoryBytes() const {
    // Of OpenSubdiv's tables about what it took for a corner of a cage of 100 000 quads.
    constexpr std::uint64_t kBytesPerCorner = 160;
    const PolygonMesh& mesh = m_cage.mesh;
    return mesh.vertexIndices.size() * kBytesPerCorner +
           mesh.positions.size() * (sizeof(Vec3f) + 3 * sizeof(double)) +
           mesh.texcoords.size() * (sizeof(Vec2f) + 2 * sizeof(double)) +
           (m_ofEdges.size() + m_ofVertices.size()) * sizeof(Owner) +
           m_mostPieces.size() * sizeof(m_mostPieces[0]);
}

}  // namespace pm
