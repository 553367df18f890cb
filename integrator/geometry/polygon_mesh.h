// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "integrator/values/cancel_check.h"
#include "integrator/values/kept.h"
#include "integrator/values/vec.h"

namespace pm {

// A mesh as a host describes it: faces of three or more corners, one after another in the index
// arrays. Positions in scene units; the front of a face is the side from which its corners run
// counterclockwise.
struct PolygonMesh {
    std::vector<Vec3f> positions;
    std::vector<std::uint32_t> faceVertexCounts;  // corners of each face, 3 to kMaxFaceSize
    std::vector<std::uint32_t> vertexIndices;     // into positions, one for each corner

    // Optional, with indices of their own: the index arrays are empty (nothing given) or hold one
    // entry for each corner, -1 where a corner has none.
    std::vector<Vec3f> normals;
    std::vector<std::int32_t> normalIndices;
    std::vector<Vec2f> texcoords;
    std::vector<std::int32_t> texcoordIndices;

    std::vector<std::uint32_t> faceMaterials;  // slot of each face; empty means slot 0 for all

    std::size_t faceCount() const { return faceVertexCounts.size(); }
};

// What OpenSubdiv can take, and more than any mesh has had use for.
inline constexpr std::uint32_t kMaxFaceSize = 65535;
// Beyond about 1.8e18 the ray tracer refuses a ray's origin.
inline constexpr float kMaxCoordinate = 1e18f;

// What the ray tracer gets. Positions in scene units; counterclockwise seen from the front.
struct TriangleMesh {
    using Corners = std::array<std::uint32_t, 3>;

    std::vector<Vec3f> positions;
    std::vector<Corners> triangles;  // into positions

    // Empty, or one entry for each triangle; then every index is valid and every normal a finite
    // unit vector. Corners for which none was given have the normal of their polygon.
    std::vector<Vec3f> normals;
    std::vector<Corners> normalIndices;
    // Empty, or one entry for each triangle; corners for which none was given have (0, 0).
    std::vector<Vec2f> texcoords;
    std::vector<Corners> texcoordIndices;

    std::vector<std::uint32_t> materials;  // slot of each triangle
    std::vector<std::uint32_t> faces;      // the polygon each triangle came from

    Kept rayTracing;  // the SharedMesh of its instances
    Kept tangents;    // the Tangents of its corners
};

// What was put right on the way to triangles, for one warning each.
struct MeshRepairs {
    std::size_t droppedTriangles = 0;  // without area
    std::size_t replacedNormals = 0;   // zero, infinite or NaN
    std::size_t fannedFaces = 0;       // cross themselves, so no triangulation is right
    std::size_t ignoredCreases = 0;    // pairs of vertices that no face has as an edge
    // Vertices of only two faces next to creases, which OpenSubdiv can't evaluate: sharp here.
    std::size_t openedVertices = 0;
};

struct BuiltMesh {
    TriangleMesh mesh;
    MeshRepairs repairs;
};

// Throws Error(kInvalidScene) unless every index is in range, every face has 3 to kMaxFaceSize
// corners, the arrays fit each other and all positions and texture coordinates are finite
// (positions within kMaxCoordinate). Bad normals pass: triangulate() replaces them. Throws
// Error(kCancelled) soon after cancel is set.
void validate(const PolygonMesh& mesh, const CancelCheck& cancel = {});

// True when a triangle has no area to speak of: a corner is met twice or all three are in line.
bool isDegenerateTriangle(const Vec3f& a, const Vec3f& b, const Vec3f& c);

}  // namespace pm
