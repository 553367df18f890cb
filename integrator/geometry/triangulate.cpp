// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/geometry/triangulate.h"

#include <cmath>
#include <utility>

#include "integrator/geometry/polygon_clipper.h"

namespace pm {
namespace {

constexpr std::uint32_t kNone = 0xffffffffu;

// Triangulates the faces of one mesh, one after another.
class MeshTriangulator {
  public:
    MeshTriangulator(const PolygonMesh& source, const CancelCheck& cancel);
    BuiltMesh build();

  private:
    void goOn() const { m_cancel.throwIfSet("cutting faces into triangles"); }
    void addFace(std::size_t face, std::uint32_t size);
    void addTriangle(std::size_t face, const TriangleMesh::Corners& corners);
    std::uint32_t normalOf(std::size_t corner);
    std::uint32_t faceNormal();
    std::uint32_t texcoordOf(std::size_t corner);

    const PolygonMesh& m_source;
    const CancelCheck m_cancel;
    BuiltMesh m_built;
    PolygonClipper m_clipper;
    std::vector<bool> m_goodNormals;

    // Of the face at hand.
    std::size_t m_firstCorner = 0;
    std::vector<Vec3d> m_points;
    std::vector<TriangleMesh::Corners> m_triangles;
    std::uint32_t m_faceNormal = kNone;

    std::uint32_t m_zeroTexcoord = kNone;
};

MeshTriangulator::MeshTriangulator(const PolygonMesh& source, const CancelCheck& cancel)
    : m_source(source), m_cancel(cancel) {
    TriangleMesh& mesh = m_built.mesh;
    mesh.positions = source.positions;
    if (!source.texcoordIndices.empty()) mesh.texcoords = source.texcoords;
    if (source.normalIndices.empty()) return;
    m_goodNormals.reserve(source.normals.size());
    for (const Vec3f& given : source.normals) {
        goOn();
        const Vec3d normal(given);
        const double size = length(normal);
        const bool good = std::isfinite(size) && size > 0;
        m_goodNormals.push_back(good);
        mesh.normals.push_back(good ? Vec3f(normal / size) : Vec3f(0, 0, 1));
        if (!good) ++m_built.repairs.replacedNormals;
    }
}

BuiltMesh MeshTriangulator::build() {
    for (std::size_t face = 0; face < m_source.faceCount(); ++face) {
        goOn();
        addFace(face, m_source.faceVertexCounts[face]);
    }
    return std::move(m_built);
}

void MeshTriangulator::addFace(std::size_t face, std::uint32_t size) {
    m_points.clear();
    for (std::uint32_t i = 0; i < size; ++i) {
        m_points.emplace_back(m_source.positions[m_source.vertexIndices[m_firstCorner + i]]);
    }
    m_triangles.clear();
    m_faceNormal = kNone;
    if (!m_clipper.clip(m_points, m_triangles)) ++m_built.repairs.fannedFaces;
    for (const TriangleMesh::Corners& corners : m_triangles) addTriangle(face, corners);
    m_firstCorner += size;
}

void MeshTriangulator::addTriangle(std::size_t face, const TriangleMesh::Corners& corners) {
    TriangleMesh& mesh = m_built.mesh;
    TriangleMesh::Corners vertices{}, normals{}, texcoords{};
    for (std::size_t i = 0; i < 3; ++i) {
        vertices[i] = m_source.vertexIndices[m_firstCorner + corners[i]];
    }
    if (isDegenerateTriangle(mesh.positions[vertices[0]], mesh.positions[vertices[1]],
                             mesh.positions[vertices[2]])) {
        ++m_built.repairs.droppedTriangles;
        return;
    }
    mesh.triangles.push_back(vertices);
    mesh.faces.push_back(static_cast<std::uint32_t>(face));
    mesh.materials.push_back(m_source.faceMaterials.empty() ? 0 : m_source.faceMaterials[face]);
    if (!m_source.normalIndices.empty()) {
        for (std::size_t i = 0; i < 3; ++i) normals[i] = normalOf(m_firstCorner + corners[i]);
        mesh.normalIndices.push_back(normals);
    }
    if (!m_source.texcoordIndices.empty()) {
        for (std::size_t i = 0; i < 3; ++i) texcoords[i] = texcoordOf(m_firstCorner + corners[i]);
        mesh.texcoordIndices.push_back(texcoords);
    }
}

std::uint32_t MeshTriangulator::normalOf(std::size_t corner) {
    const std::int32_t index = m_source.normalIndices[corner];
    if (index >= 0 && m_goodNormals[static_cast<std::size_t>(index)]) {
        return static_cast<std::uint32_t>(index);
    }
    return faceNormal();
}

// Added to the normals when a corner first asks for it.
std::uint32_t MeshTriangulator::faceNormal() {
    if (m_faceNormal != kNone) return m_faceNormal;
    Vec3d normal = newellNormal(m_points);
    for (const TriangleMesh::Corners& c : m_triangles) {
        // A polygon can cancel itself out; its triangles can't all.
        if (length(normal) > 0) break;
        normal = cross(m_points[c[1]] - m_points[c[0]], m_points[c[2]] - m_points[c[0]]);
    }
    m_faceNormal = static_cast<std::uint32_t>(m_built.mesh.normals.size());
    m_built.mesh.normals.emplace_back(length(normal) > 0 ? normalize(normal) : Vec3d(0, 0, 1));
    return m_faceNormal;
}

std::uint32_t MeshTriangulator::texcoordOf(std::size_t corner) {
    const std::int32_t index = m_source.texcoordIndices[corner];
    if (index >= 0) return static_cast<std::uint32_t>(index);
    if (m_zeroTexcoord == kNone) {
        m_zeroTexcoord = static_cast<std::uint32_t>(m_built.mesh.texcoords.size());
        m_built.mesh.texcoords.push_back({});
    }
    return m_zeroTexcoord;
}

}  // namespace

BuiltMesh triangulate(const PolygonMesh& mesh, const CancelCheck& cancel) {
    validate(mesh, cancel);
    return MeshTriangulator(mesh, cancel).build();
}

}  // namespace pm
