// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/shapes/tangents.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

#include "integrator/sampling/pinned_math.h"

namespace pm {

namespace {

constexpr std::uint32_t kNone = 0xffffffffu;

using Corners = TriangleMesh::Corners;

// What a corner says; corners that say the same are one.
struct CornerValues {
    Vec3f position, normal;
    Vec2f uv;

    // By value: 0 and -0 are one.
    auto key() const {
        return std::tuple(position.x, position.y, position.z, normal.x, normal.y, normal.z, uv.x,
                          uv.y);
    }
};

// Of a triangle: where u grows, and whether its texture coordinates say so.
struct UDirection {
    Vec3d u;
    bool hasArea = false;
    bool isMirrored = false;
};

Vec3d unitOrNone(const Vec3d& v) {
    const double l2 = lengthSquared(v);
    return l2 > 0.0 ? v / std::sqrt(l2) : Vec3d{};
}

// Of v what is at right angles to the unit normal.
Vec3d flattened(const Vec3d& v, const Vec3d& normal) {
    return unitOrNone(v - normal * dot(v, normal));
}

std::size_t next(std::size_t corner) {
    return corner < 2 ? corner + 1 : 0;
}
std::size_t previous(std::size_t corner) {
    return corner > 0 ? corner - 1 : 2;
}

class TangentMaker {
  public:
    TangentMaker(const TriangleMesh& mesh, const CancelCheck& cancel)
        : m_mesh(mesh), m_cancel(cancel) {
        findFacetNormals();
        weld();
        findNeighbours();
        findDirections();
    }

    // Gathers the corners around each vertex, in the order of the triangles that begin.
    void run(std::vector<Vec3f>& tangents, std::vector<Corners>& indices) {
        tangents.assign(1, Vec3f());
        indices.assign(count(), Corners{0, 0, 0});
        for (std::uint32_t t = 0; t < count(); ++t) {
            goOn(t);
            if (!m_directions[t].hasArea) continue;
            for (std::size_t corner = 0; corner < 3; ++corner) {
                if (indices[t][corner] != 0) continue;
                const auto group = static_cast<std::uint32_t>(tangents.size());
                tangents.push_back(gather(t, m_vertices[t][corner], group, indices));
            }
        }
    }

    bool isMirrored(std::uint32_t triangle) const { return m_directions[triangle].isMirrored; }
    std::uint32_t count() const { return static_cast<std::uint32_t>(m_mesh.triangles.size()); }

  private:
    void goOn(std::uint32_t step) const {
        constexpr std::uint32_t kStepsBetweenLooks = 1 << 16;
        if (step % kStepsBetweenLooks == 0) m_cancel.throwIfSet("making tangents");
    }

    Vec3d edge(std::uint32_t t, std::size_t from, std::size_t to) const {
        return Vec3d(m_mesh.positions[m_mesh.triangles[t][to]]) -
               Vec3d(m_mesh.positions[m_mesh.triangles[t][from]]);
    }
    const Vec2f& uv(std::uint32_t t, std::size_t corner) const {
        return m_mesh.texcoords[m_mesh.texcoordIndices[t][corner]];
    }
    const Vec3f& normal(std::uint32_t t, std::size_t corner) const {
        return m_mesh.normals.empty() ? m_facetNormals[t]
                                      : m_mesh.normals[m_mesh.normalIndices[t][corner]];
    }
    CornerValues values(std::uint32_t corner) const {
        const std::uint32_t t = corner / 3;
        const std::size_t k = corner % 3;
        return {m_mesh.positions[m_mesh.triangles[t][k]], normal(t, k), uv(t, k)};
    }

    void findFacetNormals() {
        if (!m_mesh.normals.empty()) return;
        m_facetNormals.reserve(count());
        for (std::uint32_t t = 0; t < count(); ++t)
            m_facetNormals.emplace_back(unitOrNone(cross(edge(t, 0, 1), edge(t, 0, 2))));
    }

    // Numbers of the corners that are one, by values: files write the same ones several times.
    void weld() {
        std::vector<std::uint32_t> order(3 * static_cast<std::size_t>(count()));
        std::iota(order.begin(), order.end(), 0u);
        std::ranges::sort(order, [&](std::uint32_t a, std::uint32_t b) {
            const auto ofA = values(a).key(), ofB = values(b).key();
            return ofA != ofB ? ofA < ofB : a < b;
        });
        m_cancel.throwIfSet("making tangents");
        m_vertices.resize(count());
        std::uint32_t vertex = 0;
        for (std::size_t i = 0; i < order.size(); ++i) {
            if (i > 0 && values(order[i - 1]).key() != values(order[i]).key()) ++vertex;
            m_vertices[order[i] / 3][order[i] % 3] = vertex;
        }
    }

    // Two triangles are neighbours where one runs along an edge and the other back. An edge of more
    // than two has pairs, first come, first served.
    void findNeighbours() {
        struct Edge {
            std::uint32_t low, high, corner;
            bool runsUp;
        };
        std::vector<Edge> edges;
        edges.reserve(3 * static_cast<std::size_t>(count()));
        for (std::uint32_t t = 0; t < count(); ++t)
            for (std::size_t k = 0; k < 3; ++k) {
                const std::uint32_t from = m_vertices[t][k], to = m_vertices[t][next(k)];
                edges.push_back({std::min(from, to), std::max(from, to),
                                 3 * t + static_cast<std::uint32_t>(k), from < to});
            }
        std::ranges::sort(edges, {},
                          [](const Edge& e) { return std::tuple(e.low, e.high, e.corner); });
        m_cancel.throwIfSet("making tangents");
        m_neighbours.assign(count(), Corners{kNone, kNone, kNone});
        for (std::size_t first = 0, end = 0; first < edges.size(); first = end) {
            const auto isSame = [&](const Edge& e) {
                return e.low == edges[first].low && e.high == edges[first].high;
            };
            std::vector<std::uint32_t> up, down;
            for (end = first; end < edges.size() && isSame(edges[end]); ++end)
                (edges[end].runsUp ? up : down).push_back(edges[end].corner);
            for (std::size_t i = 0; i < std::min(up.size(), down.size()); ++i) {
                m_neighbours[up[i] / 3][up[i] % 3] = down[i] / 3;
                m_neighbours[down[i] / 3][down[i] % 3] = up[i] / 3;
            }
        }
    }

    void findDirections() {
        m_directions.reserve(count());
        for (std::uint32_t t = 0; t < count(); ++t) {
            const auto change = [&](std::size_t k) {
                return Vec3d{static_cast<double>(uv(t, k).x) - static_cast<double>(uv(t, 0).x),
                             static_cast<double>(uv(t, k).y) - static_cast<double>(uv(t, 0).y), 0};
            };
            const Vec3d d1 = change(1), d2 = change(2);
            const double area = d1.x * d2.y - d1.y * d2.x;
            const Vec3d u = edge(t, 0, 1) * d2.y - edge(t, 0, 2) * d1.y;
            m_directions.push_back({unitOrNone(area < 0.0 ? -u : u),
                                    area != 0.0 && lengthSquared(u) > 0.0, area < 0.0});
        }
    }

    // The triangle's angle at a corner, seen along its normal.
    double angle(std::uint32_t t, std::size_t corner, const Vec3d& n) const {
        const Vec3d a = flattened(edge(t, corner, next(corner)), n),
                    b = flattened(edge(t, corner, previous(corner)), n);
        return pinnedAtan2Turns(length(cross(a, b)), dot(a, b));
    }

    // The mean around a vertex, of all triangles that are reached from one over edges and run the
    // same way round. Those without area of texture coordinates go with the first that reach them.
    Vec3f gather(std::uint32_t begin, std::uint32_t vertex, std::uint32_t group,
                 std::vector<Corners>& indices) {
        const bool isMirrored = m_directions[begin].isMirrored;
        Vec3d sum;
        m_toVisit.assign(1, begin);
        while (!m_toVisit.empty()) {
            const std::uint32_t t = m_toVisit.back();
            m_toVisit.pop_back();
            const auto found = std::ranges::find(m_vertices[t], vertex);
            const auto corner = static_cast<std::size_t>(found - m_vertices[t].begin());
            if (corner == 3 || indices[t][corner] != 0) continue;
            UDirection& direction = m_directions[t];
            if (!direction.hasArea && indices[t] == Corners{0, 0, 0})
                direction.isMirrored = isMirrored;
            if (direction.isMirrored != isMirrored) continue;
            indices[t][corner] = group;
            if (direction.hasArea) {
                const Vec3d n(normal(t, corner));
                sum += flattened(direction.u, n) * angle(t, corner, n);
            }
            for (const std::size_t side : {corner, previous(corner)})
                if (m_neighbours[t][side] != kNone) m_toVisit.push_back(m_neighbours[t][side]);
        }
        return Vec3f(unitOrNone(sum));
    }

    const TriangleMesh& m_mesh;
    const CancelCheck& m_cancel;
    std::vector<Vec3f> m_facetNormals;  // of a mesh without normals
    std::vector<Corners> m_vertices;    // of each corner
    std::vector<Corners> m_neighbours;  // triangles, over the edges that begin at the corners
    std::vector<UDirection> m_directions;
    std::vector<std::uint32_t> m_toVisit;
};

}  // namespace

Tangents::Tangents(const TriangleMesh& mesh, const CancelCheck& cancel) {
    TangentMaker maker(mesh, cancel);
    maker.run(m_tangents, m_indices);
    m_isMirrored.reserve(maker.count());
    for (std::uint32_t t = 0; t < maker.count(); ++t) m_isMirrored.push_back(maker.isMirrored(t));
}

std::shared_ptr<const Tangents> Tangents::of(const TriangleMesh& mesh, const CancelCheck& cancel) {
    return mesh.tangents.get<Tangents>(
        [](const Tangents&) { return true; },
        [&] { return std::make_shared<const Tangents>(mesh, cancel); });
}

}  // namespace pm
