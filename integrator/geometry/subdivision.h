// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "integrator/geometry/polygon_mesh.h"
#include "integrator/values/cancel_check.h"

namespace pm {

enum class SubdivisionScheme { kCatmullClark, kLoop, kBilinear };

// What a boundary of the cage becomes. kNone: faces at a boundary have no surface.
enum class BoundaryInterpolation { kNone, kEdgeOnly, kEdgeAndCorner };

// Where texture coordinates are interpolated linearly instead of smoothly (names of OpenSubdiv).
// kBoundaries, smooth inside and linear along the edges of charts, is what modelling programs do.
enum class FaceVaryingInterpolation {
    kSmooth,
    kCornersOnly,
    kCornersPlus1,
    kCornersPlus2,
    kBoundaries,
    kAllLinear
};

// How semi-sharp creases of unlike sharpness go over into each other.
enum class CreaseMethod { kUniform, kChaikin };

// At or above it an edge or corner stays sharp in the limit.
inline constexpr float kInfiniteSharpness = 10.0f;

struct Crease {
    std::array<std::uint32_t, 2> vertices{};  // the two ends of an edge
    float sharpness = 0;                      // number of refinements it survives, >= 0, finite
};

struct SharpCorner {
    std::uint32_t vertex = 0;
    float sharpness = 0;  // as of Crease
};

// A polygon mesh that stands for the limit of its subdivision. Its normals are not used.
struct SubdivisionCage {
    PolygonMesh mesh;
    SubdivisionScheme scheme = SubdivisionScheme::kCatmullClark;
    BoundaryInterpolation boundary = BoundaryInterpolation::kEdgeAndCorner;
    FaceVaryingInterpolation faceVarying = FaceVaryingInterpolation::kBoundaries;
    CreaseMethod creaseMethod = CreaseMethod::kUniform;
    bool smoothTriangles = false;  // other weights for triangles under Catmull-Clark
    std::vector<Crease> creases;
    std::vector<SharpCorner> corners;
    std::vector<std::uint32_t> holes;  // faces that shape their neighbours but are not there
};

// Throws Error(kInvalidScene) for all that OpenSubdiv would crash on or could not represent:
// whatever validate(PolygonMesh) rejects, creases, corners and holes out of range, a sharpness that
// is negative or not finite, more than 65535 edges or faces at a vertex, and under Loop faces that
// are no triangles.
void validate(const SubdivisionCage& cage);

// The size of what tessellate() would build, known beforehand and for little effort.
struct TessellationSize {
    std::uint64_t triangles = 0;  // exact, unless faces at a boundary are left out
    std::uint64_t bytes = 0;      // of the finished mesh, at most
};

inline constexpr int kMaxTessellationRate = 1024;

// Errors: as of tessellate().
TessellationSize tessellationSize(const SubdivisionCage& cage, int rate);

// Triangles on the limit surface of a cage, with its normals and texture coordinates. Every edge of
// the cage is cut into `rate` (1 to kMaxTessellationRate) pieces; points on edges and at vertices
// are evaluated once and shared, so the mesh has no crack. Normals are those of the face they
// belong to, so an infinitely sharp crease stays visible; where the surface has none, the triangles
// around the point give it, counted in `repairs`. Triangles without area stay in: leaving them out
// could open the mesh. Errors: validate(), kInvalidArgument for the rate, kInvalidScene for more
// than 2^32 - 1 indices; kCancelled soon after cancel is set, but while the cage is connected.
// Threads: runs on the caller's TBB arena; the result is the same for any number of threads.
BuiltMesh tessellate(const SubdivisionCage& cage, int rate, const CancelCheck& cancel = {});

}  // namespace pm
