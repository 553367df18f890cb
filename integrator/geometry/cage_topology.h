// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// The edges of a cage, and the cage cut open where it is not a surface. OpenSubdiv 3.5 accepts
// edges with three faces, turned over neighbours, cones that touch in a point and faces that meet a
// vertex twice, but then its limit evaluation reads outside its arrays. Its rule for such edges and
// vertices is that they are infinitely sharp; cutting them open and sharpening them says the same.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "integrator/geometry/subdivision.h"

namespace pm {

class CageTopology {
  public:
    // The cage must have passed validate() and outlive this. Creases and corners of the result are
    // left to the caller.
    explicit CageTopology(const SubdivisionCage& cage);

    // Corners of a face are numbered from here on, as in PolygonMesh::vertexIndices.
    std::uint32_t firstCorner(std::size_t face) const { return m_firstCorners[face]; }
    std::uint32_t nextCorner(std::uint32_t corner) const { return m_next[corner]; }

    // The edge from a corner to the next one of its face, of edgeCount().
    std::uint32_t edgeOf(std::uint32_t corner) const { return m_edgeOfCorner[corner]; }
    std::uint32_t edgeCount() const { return static_cast<std::uint32_t>(m_edges.size()); }
    // The two vertices of an edge, the lower one first.
    std::pair<std::uint32_t, std::uint32_t> edge(std::uint32_t index) const;
    // The edge between two vertices, or edgeCount().
    std::uint32_t findEdge(std::uint32_t a, std::uint32_t b) const;
    // Whether an edge has been cut, so that it has to be sharp.
    bool isCut(std::uint32_t edge) const { return m_edgeIsCut[edge]; }

    // The vertex of the cut cage at a corner, of copyCount(); its vertex in the cage is originOf().
    std::uint32_t copyOf(std::uint32_t corner) const { return m_copyOfCorner[corner]; }
    std::uint32_t copyCount() const { return static_cast<std::uint32_t>(m_origins.size()); }
    std::uint32_t originOf(std::uint32_t copy) const { return m_origins[copy]; }
    // Whether all copies of a vertex of the cage have to be sharp, so that they stay together.
    bool isSharp(std::uint32_t vertex) const { return m_vertexIsSharp[vertex]; }

    // How many vertices of two faces were cut open.
    std::size_t openedVertices() const { return m_openedVertices; }

  private:
    void numberCorners();
    void findEdges();
    void joinFans();
    bool cutFurther();
    bool openPairs();
    std::vector<bool> creasedVertices() const;
    bool hasCreaseAround(std::uint32_t corner, const std::vector<bool>& creased) const;
    void findSharpVertices();
    bool isSurfaceEdge(std::uint32_t first, std::uint32_t second) const;
    void numberCopies();

    const SubdivisionCage& m_cage;
    const PolygonMesh& m_mesh;
    std::vector<std::uint32_t> m_firstCorners, m_faceOfCorner, m_next;
    std::vector<std::uint64_t> m_edges;  // lower vertex << 32 | higher vertex, in order
    std::vector<std::uint32_t> m_edgeOfCorner;
    std::vector<std::vector<std::uint32_t>> m_cutGroups;  // corners of each edge that has been cut
    std::vector<bool> m_mustCut;  // edges that are to be cut though the cage is a surface there
    std::size_t m_openedVertices = 0;
    std::vector<bool> m_edgeIsCut, m_edgeIsBoundary, m_vertexIsSharp;
    std::vector<std::uint32_t> m_copyOfCorner, m_origins;
};

}  // namespace pm
