// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Triangles on a limit surface. Points on edges and at vertices of the cage belong to the first
// face that has them: evaluating them from two faces would not give equal bits, and the mesh would
// crack.
#include "integrator/geometry/subdivision.h"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "integrator/geometry/limit_surface.h"
#include "integrator/values/error.h"

namespace pm {
namespace {

constexpr std::uint32_t kNone = 0xffffffffu;
// Two faces' normals at a shared point are one when they differ by less than about 1e-3 radians.
constexpr float kSameNormalCosine = 1.0f - 5e-7f;

void checkRate(int rate) {
    if (rate >= 1 && rate <= kMaxTessellationRate) return;
    throw Error(Status::kInvalidArgument, fmt::format("tessellation rate is {}; it must be 1 to {}",
                                                      rate, kMaxTessellationRate));
}

// Unit normal from two tangents, or zero when they don't span a plane.
Vec3f normalOf(const Vec3d& du, const Vec3d& dv) {
    const double lengthU = length(du), lengthV = length(dv);
    const Vec3d normal = cross(du, dv);
    const double size = length(normal);
    // Below these ratios a tangent is rounding noise.
    constexpr double kLeastRatio = 1e-7;
    const bool good = std::min(lengthU, lengthV) > kLeastRatio * std::max(lengthU, lengthV) &&
                      size > kLeastRatio * lengthU * lengthV && std::isfinite(size);
    return good ? Vec3f(normal / size) : Vec3f(0);
}

// Builds the mesh of one cage.
class LimitMesher {
  public:
    LimitMesher(const SubdivisionCage& cage, int rate, const CancelCheck& cancel)
        : m_cage(cage), m_rate(rate), m_cancel(cancel), m_limit(cage) {}
    BuiltMesh build();

  private:
    // Where the points and triangles of a face go.
    struct Face {
        const SamplePattern* pattern = nullptr;  // null: the face has no surface
        std::uint32_t firstSample = 0;           // of its own normals and texture coordinates
        std::uint32_t firstInterior = 0;         // point
        std::size_t firstTriangle = 0;
    };
    // The points of an edge or vertex, and the face that evaluates them.
    struct Shared {
        std::uint32_t firstPoint = kNone;
        std::uint32_t owner = kNone;
    };
    // Memory of one worker, used for one face after another.
    struct Scratch {
        std::vector<LimitSurface::FaceCorner> corners;
        std::vector<std::uint32_t> points;  // of the mesh, for each sample of the face
        std::vector<bool> owned;            // whether this face evaluates that point
    };

    void goOn() const { m_cancel.throwIfSet("tessellating"); }
    void layOut();
    void layOutFace(std::uint32_t face);
    void allocate();
    void fillFaces();
    void listPoints(std::uint32_t face, Scratch& scratch) const;
    void evaluateSamples(std::uint32_t face, const Scratch& scratch,
                         LimitSurface::Evaluator& evaluator);
    void fillTriangles(std::uint32_t face, const Scratch& scratch);
    void checkPositions() const;
    void joinNormals();
    std::uint32_t joinNormal(std::uint32_t point, const Vec3f& normal);
    Vec3f normalAround(const Face& face, std::uint32_t sample) const;

    const SubdivisionCage& m_cage;
    const int m_rate;
    const CancelCheck m_cancel;
    LimitSurface m_limit;
    std::map<std::uint32_t, SamplePattern> m_patterns;  // by the size of the face
    std::vector<Face> m_faces;
    std::vector<Shared> m_vertices, m_edges;
    std::uint64_t m_pointCount = 0, m_sampleCount = 0, m_triangleCount = 0;
    std::vector<std::uint32_t> m_normalOfPoint;
    std::uint32_t m_normalCount = 0;
    BuiltMesh m_built;
};

BuiltMesh LimitMesher::build() {
    layOut();
    allocate();
    fillFaces();
    checkPositions();
    joinNormals();
    m_built.repairs.ignoredCreases = m_limit.ignoredCreases();
    m_built.repairs.openedVertices = m_limit.openedVertices();
    return std::move(m_built);
}

void LimitMesher::layOut() {
    m_faces.resize(m_cage.mesh.faceCount());
    m_vertices.resize(m_cage.mesh.positions.size());
    m_edges.resize(m_limit.edgeCount());
    for (std::uint32_t face = 0; face < m_faces.size(); ++face) {
        goOn();
        if (m_limit.hasSurface(face)) layOutFace(face);
        if (m_sampleCount >= kNone || 3 * m_triangleCount >= kNone) {
            throw Error(Status::kInvalidScene,
                        fmt::format("{} faces at tessellation rate {} make too many triangles; "
                                    "one mesh holds {}",
                                    m_faces.size(), m_rate, kNone / 3));
        }
    }
}

void LimitMesher::layOutFace(std::uint32_t face) {
    const std::uint32_t size = m_cage.mesh.faceVertexCounts[face];
    auto found = m_patterns.find(size);
    if (found == m_patterns.end()) {
        found = m_patterns.emplace(size, makeSamplePattern(m_cage.scheme, size, m_rate)).first;
    }
    const SamplePattern& pattern = found->second;
    const auto claim = [&](Shared& shared, int points) {
        if (shared.owner != kNone) return;
        shared = {static_cast<std::uint32_t>(m_pointCount), face};
        m_pointCount += static_cast<std::uint64_t>(points);
    };
    std::vector<LimitSurface::FaceCorner> corners;
    m_limit.listCorners(face, corners);
    for (const LimitSurface::FaceCorner& corner : corners) {
        claim(m_vertices[corner.vertex], 1);
        claim(m_edges[corner.edge], m_rate - 1);
    }
    m_faces[face] = {&pattern, static_cast<std::uint32_t>(m_sampleCount),
                     static_cast<std::uint32_t>(m_pointCount), m_triangleCount};
    m_pointCount += pattern.pointCount() - pattern.boundaryPoints;
    m_sampleCount += pattern.pointCount();
    m_triangleCount += pattern.facets.size();
}

void LimitMesher::allocate() {
    TriangleMesh& mesh = m_built.mesh;
    // So much memory takes a while to get.
    const auto resize = [this](auto& array, std::uint64_t size) {
        goOn();
        array.resize(size);
    };
    resize(mesh.positions, m_pointCount);
    resize(mesh.triangles, m_triangleCount);
    resize(mesh.normals, m_sampleCount);
    resize(mesh.normalIndices, m_triangleCount);
    resize(mesh.materials, m_triangleCount);
    resize(mesh.faces, m_triangleCount);
    if (!m_limit.hasTexcoords()) return;
    resize(mesh.texcoords, m_sampleCount);
    resize(mesh.texcoordIndices, m_triangleCount);
}

// Every face writes only what is its own, so the order of the faces changes nothing.
void LimitMesher::fillFaces() {
    constexpr std::uint32_t kFacesPerTask = 64;
    const auto count = static_cast<std::uint32_t>(m_faces.size());
    tbb::parallel_for(tbb::blocked_range<std::uint32_t>(0, count, kFacesPerTask),
                      [this](const tbb::blocked_range<std::uint32_t>& range) {
                          LimitSurface::Evaluator evaluator(m_limit);
                          Scratch scratch;
                          for (std::uint32_t face = range.begin(); face < range.end(); ++face) {
                              goOn();
                              if (m_faces[face].pattern == nullptr) continue;
                              evaluator.select(face);
                              listPoints(face, scratch);
                              evaluateSamples(face, scratch, evaluator);
                              fillTriangles(face, scratch);
                          }
                      });
}

void LimitMesher::listPoints(std::uint32_t index, Scratch& scratch) const {
    const Face& face = m_faces[index];
    scratch.points.clear();
    scratch.owned.clear();
    const auto add = [&](std::uint32_t point, bool owned) {
        scratch.points.push_back(point);
        scratch.owned.push_back(owned);
    };
    const auto between = static_cast<std::uint32_t>(m_rate - 1);
    m_limit.listCorners(index, scratch.corners);
    for (const LimitSurface::FaceCorner& corner : scratch.corners) {
        const Shared& vertex = m_vertices[corner.vertex];
        const Shared& edge = m_edges[corner.edge];
        add(vertex.firstPoint, vertex.owner == index);
        for (std::uint32_t k = 0; k < between; ++k) {
            const std::uint32_t step = corner.forwards ? k : between - 1 - k;
            add(edge.firstPoint + step, edge.owner == index);
        }
    }
    const std::uint32_t interior = face.pattern->pointCount() - face.pattern->boundaryPoints;
    for (std::uint32_t k = 0; k < interior; ++k) add(face.firstInterior + k, true);
}

void LimitMesher::evaluateSamples(std::uint32_t index, const Scratch& scratch,
                                  LimitSurface::Evaluator& evaluator) {
    const Face& face = m_faces[index];
    TriangleMesh& mesh = m_built.mesh;
    for (std::uint32_t i = 0; i < face.pattern->pointCount(); ++i) {
        const LimitSurface::Sample sample =
            evaluator.evaluate(&face.pattern->coords[2 * std::size_t{i}]);
        if (scratch.owned[i]) mesh.positions[scratch.points[i]] = Vec3f(sample.position);
        mesh.normals[face.firstSample + i] = normalOf(sample.tangentU, sample.tangentV);
        if (!mesh.texcoords.empty()) mesh.texcoords[face.firstSample + i] = sample.texcoord;
    }
}

void LimitMesher::fillTriangles(std::uint32_t index, const Scratch& scratch) {
    const Face& face = m_faces[index];
    TriangleMesh& mesh = m_built.mesh;
    const std::vector<std::uint32_t>& materials = m_cage.mesh.faceMaterials;
    for (std::size_t i = 0; i < face.pattern->facets.size(); ++i) {
        const std::size_t triangle = face.firstTriangle + i;
        for (std::size_t corner = 0; corner < 3; ++corner) {
            const std::uint32_t sample = face.pattern->facets[i][corner];
            mesh.triangles[triangle][corner] = scratch.points[sample];
            if (!mesh.texcoords.empty())
                mesh.texcoordIndices[triangle][corner] = face.firstSample + sample;
        }
        mesh.faces[triangle] = index;
        mesh.materials[triangle] = materials.empty() ? 0 : materials[index];
    }
}

void LimitMesher::checkPositions() const {
    for (const Vec3f& p : m_built.mesh.positions) {
        if (isFinite(p) && maxAbsComponent(p) <= kMaxCoordinate) continue;
        throw Error(Status::kInvalidScene,
                    fmt::format("the limit surface reaches ({}, {}, {}); at most +-{} is allowed",
                                p.x, p.y, p.z, kMaxCoordinate));
    }
}

// The faces around a smooth point agree on its normal but for rounding: keeps one of these, and all
// those that differ, moved to the front of the array. One thread, in the order of the faces.
void LimitMesher::joinNormals() {
    TriangleMesh& mesh = m_built.mesh;
    m_normalOfPoint.assign(mesh.positions.size(), kNone);
    Scratch scratch;
    std::vector<std::uint32_t> joined;
    for (std::uint32_t index = 0; index < m_faces.size(); ++index) {
        goOn();
        const Face& face = m_faces[index];
        if (face.pattern == nullptr) continue;
        listPoints(index, scratch);
        joined.clear();
        for (std::uint32_t i = 0; i < face.pattern->pointCount(); ++i) {
            Vec3f normal = mesh.normals[face.firstSample + i];
            if (normal == Vec3f(0)) {
                normal = normalAround(face, i);
                ++m_built.repairs.replacedNormals;
            }
            joined.push_back(joinNormal(scratch.points[i], normal));
        }
        for (std::size_t i = 0; i < face.pattern->facets.size(); ++i) {
            for (std::size_t corner = 0; corner < 3; ++corner) {
                mesh.normalIndices[face.firstTriangle + i][corner] =
                    joined[face.pattern->facets[i][corner]];
            }
        }
    }
    mesh.normals.resize(m_normalCount);
    mesh.normals.shrink_to_fit();
}

std::uint32_t LimitMesher::joinNormal(std::uint32_t point, const Vec3f& normal) {
    std::vector<Vec3f>& normals = m_built.mesh.normals;
    std::uint32_t& first = m_normalOfPoint[point];
    if (first != kNone && dot(normals[first], normal) > kSameNormalCosine) return first;
    if (first == kNone) first = m_normalCount;
    normals[m_normalCount] = normal;
    return m_normalCount++;
}

// From the triangles of the face around a sample; where they have no area, from the whole face.
Vec3f LimitMesher::normalAround(const Face& face, std::uint32_t sample) const {
    const TriangleMesh& mesh = m_built.mesh;
    Vec3d around, whole;
    for (std::size_t i = 0; i < face.pattern->facets.size(); ++i) {
        const TriangleMesh::Corners& triangle = mesh.triangles[face.firstTriangle + i];
        const Vec3d a(mesh.positions[triangle[0]]);
        const Vec3d area =
            cross(Vec3d(mesh.positions[triangle[1]]) - a, Vec3d(mesh.positions[triangle[2]]) - a);
        whole += area;
        const TriangleMesh::Corners& facet = face.pattern->facets[i];
        if (std::find(facet.begin(), facet.end(), sample) != facet.end()) around += area;
    }
    if (length(around) > 0) return Vec3f(normalize(around));
    return length(whole) > 0 ? Vec3f(normalize(whole)) : Vec3f(0, 0, 1);
}

}  // namespace

TessellationSize tessellationSize(const SubdivisionCage& cage, int rate) {
    checkRate(rate);
    validate(cage);
    std::map<std::uint32_t, std::uint64_t> facesBySize;
    for (const std::uint32_t size : cage.mesh.faceVertexCounts) ++facesBySize[size];
    std::vector<std::uint32_t> holes = cage.holes;
    std::sort(holes.begin(), holes.end());
    holes.erase(std::unique(holes.begin(), holes.end()), holes.end());
    for (const std::uint32_t hole : holes) --facesBySize[cage.mesh.faceVertexCounts[hole]];

    std::uint64_t samples = 0, triangles = 0;
    for (const auto& [size, count] : facesBySize) {
        const SamplePattern pattern = makeSamplePattern(cage.scheme, size, rate);
        samples += count * pattern.pointCount();
        triangles += count * pattern.facets.size();
    }
    const bool hasTexcoords = !cage.mesh.texcoordIndices.empty();
    const std::uint64_t perSample = 2 * sizeof(Vec3f) + (hasTexcoords ? sizeof(Vec2f) : 0);
    const std::uint64_t perTriangle = (hasTexcoords ? 3 : 2) * sizeof(TriangleMesh::Corners) +
                                      2 * sizeof(std::uint32_t);  // material and face
    return {triangles, samples * perSample + triangles * perTriangle};
}

BuiltMesh tessellate(const SubdivisionCage& cage, int rate, const CancelCheck& cancel) {
    checkRate(rate);
    validate(cage);
    cancel.throwIfSet("tessellating");
    return LimitMesher(cage, rate, cancel).build();
}

}  // namespace pm
