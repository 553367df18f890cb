// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/geometry/cage_topology.h"

#include <algorithm>
#include <numeric>

namespace pm {
namespace {

std::uint64_t keyOf(std::uint32_t a, std::uint32_t b) {
    return std::uint64_t{std::min(a, b)} << 32 | std::max(a, b);
}

std::uint32_t rootOf(std::vector<std::uint32_t>& parents, std::uint32_t i) {
    while (parents[i] != i) i = parents[i] = parents[parents[i]];
    return i;
}

}  // namespace

CageTopology::CageTopology(const SubdivisionCage& cage) : m_cage(cage), m_mesh(cage.mesh) {
    numberCorners();
    findEdges();
    m_mustCut.resize(m_edges.size());
    do {
        joinFans();
        while (cutFurther()) {
        }
    } while (openPairs());
    numberCopies();
    findSharpVertices();
}

std::pair<std::uint32_t, std::uint32_t> CageTopology::edge(std::uint32_t index) const {
    return {static_cast<std::uint32_t>(m_edges[index] >> 32),
            static_cast<std::uint32_t>(m_edges[index])};
}

std::uint32_t CageTopology::findEdge(std::uint32_t a, std::uint32_t b) const {
    const auto found = std::lower_bound(m_edges.begin(), m_edges.end(), keyOf(a, b));
    if (found == m_edges.end() || *found != keyOf(a, b)) return edgeCount();
    return static_cast<std::uint32_t>(found - m_edges.begin());
}

void CageTopology::numberCorners() {
    std::uint32_t corner = 0;
    for (std::uint32_t face = 0; face < m_mesh.faceCount(); ++face) {
        const std::uint32_t first = corner;
        m_firstCorners.push_back(first);
        for (std::uint32_t i = 0; i < m_mesh.faceVertexCounts[face]; ++i, ++corner) {
            m_faceOfCorner.push_back(face);
            m_next.push_back(corner + 1);
        }
        m_next.back() = first;
    }
}

// Numbers the edges in the order of their vertices.
void CageTopology::findEdges() {
    m_edgeOfCorner.resize(m_next.size());
    for (std::uint32_t corner = 0; corner < m_next.size(); ++corner) {
        m_edges.push_back(
            keyOf(m_mesh.vertexIndices[corner], m_mesh.vertexIndices[m_next[corner]]));
    }
    const std::vector<std::uint64_t> keys = m_edges;
    std::sort(m_edges.begin(), m_edges.end());
    m_edges.erase(std::unique(m_edges.begin(), m_edges.end()), m_edges.end());
    for (std::size_t corner = 0; corner < keys.size(); ++corner) {
        const auto found = std::lower_bound(m_edges.begin(), m_edges.end(), keys[corner]);
        m_edgeOfCorner[corner] = static_cast<std::uint32_t>(found - m_edges.begin());
    }
}

// Two different faces that run along the edge in opposite directions.
bool CageTopology::isSurfaceEdge(std::uint32_t first, std::uint32_t second) const {
    return m_faceOfCorner[first] != m_faceOfCorner[second] &&
           m_mesh.vertexIndices[first] != m_mesh.vertexIndices[second];
}

// Joins the corners around a vertex across the edges where the cage is a surface. What is joined is
// one fan and keeps one vertex. m_copyOfCorner gets the first corner of the fan.
void CageTopology::joinFans() {
    std::vector<std::vector<std::uint32_t>> groups;
    std::vector<std::uint32_t> order(m_next.size());
    std::iota(order.begin(), order.end(), 0u);
    std::stable_sort(order.begin(), order.end(), [this](std::uint32_t a, std::uint32_t b) {
        return m_edgeOfCorner[a] < m_edgeOfCorner[b];
    });
    std::vector<std::uint32_t> parents(m_next.size());
    std::iota(parents.begin(), parents.end(), 0u);
    const auto join = [&](std::uint32_t a, std::uint32_t b) {
        const std::uint32_t rootA = rootOf(parents, a), rootB = rootOf(parents, b);
        parents[std::max(rootA, rootB)] = std::min(rootA, rootB);
    };
    m_edgeIsCut.assign(m_edges.size(), false);
    m_edgeIsBoundary.assign(m_edges.size(), false);
    m_cutGroups.clear();
    for (std::size_t begin = 0, end = 0; begin < order.size(); begin = end) {
        const std::uint32_t edge = m_edgeOfCorner[order[begin]];
        while (end < order.size() && m_edgeOfCorner[order[end]] == edge) ++end;
        const auto [low, high] = this->edge(edge);
        const std::uint32_t first = order[begin], second = order[end - 1];
        m_edgeIsBoundary[edge] = end - begin == 1 && low != high;
        if (m_edgeIsBoundary[edge]) continue;
        if (end - begin == 2 && low != high && !m_mustCut[edge] && isSurfaceEdge(first, second)) {
            join(first, m_next[second]);
            join(m_next[first], second);
            continue;
        }
        m_edgeIsCut[edge] = true;
        m_cutGroups.emplace_back(order.begin() + static_cast<std::ptrdiff_t>(begin),
                                 order.begin() + static_cast<std::ptrdiff_t>(end));
    }
    m_copyOfCorner.resize(m_next.size());
    for (std::uint32_t i = 0; i < m_next.size(); ++i) m_copyOfCorner[i] = rootOf(parents, i);
}

// Fans can still hang together around a cut edge, or hold a face twice. Takes such fans apart into
// their corners; returns whether there were any.
bool CageTopology::cutFurther() {
    std::vector<bool> broken(m_next.size());
    for (const std::vector<std::uint32_t>& group : m_cutGroups) {
        for (const std::uint32_t a : group) {
            const std::uint32_t from = m_copyOfCorner[a], to = m_copyOfCorner[m_next[a]];
            const auto sameEnds = std::count_if(group.begin(), group.end(), [&](std::uint32_t b) {
                const std::uint32_t otherFrom = m_copyOfCorner[b];
                const std::uint32_t otherTo = m_copyOfCorner[m_next[b]];
                return (otherFrom == from && otherTo == to) || (otherFrom == to && otherTo == from);
            });
            if (sameEnds > 1 || from == to) broken[from] = broken[to] = true;
        }
    }
    std::vector<std::uint32_t> copies;
    for (std::size_t face = 0; face < m_firstCorners.size(); ++face) {
        copies.clear();
        std::uint32_t corner = m_firstCorners[face];
        do {
            copies.push_back(m_copyOfCorner[corner]);
            corner = m_next[corner];
        } while (corner != m_firstCorners[face]);
        std::sort(copies.begin(), copies.end());
        for (std::size_t i = 1; i < copies.size(); ++i) {
            if (copies[i] == copies[i - 1]) broken[copies[i]] = true;
        }
    }
    // A fan of one corner is named after it, and taking it apart would change nothing.
    bool changed = false;
    for (std::uint32_t corner = 0; corner < m_next.size(); ++corner) {
        if (!broken[m_copyOfCorner[corner]] || m_copyOfCorner[corner] == corner) continue;
        m_copyOfCorner[corner] = corner;
        changed = true;
    }
    return changed;
}

std::vector<bool> CageTopology::creasedVertices() const {
    std::vector<bool> creased(m_mesh.positions.size());
    for (const Crease& crease : m_cage.creases) {
        const auto [a, b] = crease.vertices;
        if (crease.sharpness > 0 && findEdge(a, b) != edgeCount()) creased[a] = creased[b] = true;
    }
    for (std::uint32_t i = 0; i < edgeCount(); ++i) {
        if (m_edgeIsCut[i]) creased[edge(i).first] = creased[edge(i).second] = true;
    }
    return creased;
}

// Whether the face of a corner has a vertex with a creased edge.
bool CageTopology::hasCreaseAround(std::uint32_t corner, const std::vector<bool>& creased) const {
    std::uint32_t i = corner;
    do {
        if (creased[m_mesh.vertexIndices[i]]) return true;
        i = m_next[i];
    } while (i != corner);
    return false;
}

// Finds the vertices that two faces close around, near creases, and orders their edges to be cut.
// Returns whether there were any: then the fans have to be joined anew.
bool CageTopology::openPairs() {
    std::vector<std::uint32_t> sizes(m_next.size()), edgesBefore(m_next.size());
    for (std::uint32_t corner = 0; corner < m_next.size(); ++corner) {
        ++sizes[m_copyOfCorner[corner]];
        edgesBefore[m_next[corner]] = m_edgeOfCorner[corner];
    }
    const std::vector<bool> creased = creasedVertices();
    if (std::find(creased.begin(), creased.end(), true) == creased.end()) return false;

    std::vector<std::uint32_t> opened;
    for (std::uint32_t corner = 0; corner < m_next.size(); ++corner) {
        const std::uint32_t after = m_edgeOfCorner[corner], before = edgesBefore[corner];
        const auto isInside = [this](std::uint32_t e) {
            return !m_edgeIsCut[e] && !m_edgeIsBoundary[e];
        };
        if (sizes[m_copyOfCorner[corner]] != 2 || !isInside(after) || !isInside(before)) continue;
        if (!hasCreaseAround(corner, creased)) continue;
        m_mustCut[after] = m_mustCut[before] = true;
        opened.push_back(m_copyOfCorner[corner]);
    }
    std::sort(opened.begin(), opened.end());
    m_openedVertices +=
        static_cast<std::size_t>(std::unique(opened.begin(), opened.end()) - opened.begin());
    return !opened.empty();
}

// Turns the names of fans into numbers from 0 on.
void CageTopology::numberCopies() {
    std::vector<std::uint32_t> numbers(m_next.size());
    for (std::uint32_t corner = 0; corner < m_next.size(); ++corner) {
        // The corner that a fan is named after is its first.
        if (m_copyOfCorner[corner] == corner) {
            numbers[corner] = copyCount();
            m_origins.push_back(m_mesh.vertexIndices[corner]);
        }
        m_copyOfCorner[corner] = numbers[m_copyOfCorner[corner]];
    }
}

// A vertex with several copies is sharp, unless it lies inside a line of cut edges and nothing else
// happens there: then each copy is on the same smooth curve.
void CageTopology::findSharpVertices() {
    const std::size_t count = m_mesh.positions.size();
    std::vector<std::uint32_t> copies(count), cutEdges(count), cutUses(count), boundaries(count);
    std::vector<std::uint32_t> facesOfCopy(m_origins.size());
    std::vector<bool> hasLoneFace(count);
    for (const std::uint32_t copy : m_copyOfCorner) ++facesOfCopy[copy];
    for (std::uint32_t copy = 0; copy < copyCount(); ++copy) {
        ++copies[m_origins[copy]];
        if (facesOfCopy[copy] == 1) hasLoneFace[m_origins[copy]] = true;
    }
    for (std::uint32_t i = 0; i < edgeCount(); ++i) {
        const auto [low, high] = edge(i);
        for (const std::uint32_t vertex : {low, high}) {
            cutEdges[vertex] += m_edgeIsCut[i] ? 1 : 0;
            boundaries[vertex] += m_edgeIsBoundary[i] ? 1 : 0;
        }
    }
    for (const std::vector<std::uint32_t>& group : m_cutGroups) {
        for (const std::uint32_t corner : group) {
            ++cutUses[m_mesh.vertexIndices[corner]];
            ++cutUses[m_mesh.vertexIndices[m_next[corner]]];
        }
    }
    m_vertexIsSharp.resize(count);
    for (std::size_t v = 0; v < count; ++v) {
        const bool insideLine = cutEdges[v] == 2 && boundaries[v] == 0 && !hasLoneFace[v] &&
                                2 * copies[v] == cutUses[v];
        m_vertexIsSharp[v] = copies[v] > 1 && !insideLine;
    }
}

}  // namespace pm
