// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// What holds for the triangles of any cage: no cracks, no NaN, the promised size, the same for any
// number of threads; and cages that OpenSubdiv would crash on are refused.
#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <random>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "integrator/geometry/subdivision.h"
#include "integrator/values/error.h"
#include "tests/integrator/geometry/obj_cage.h"

namespace pm {
namespace {

using Edge = std::pair<std::uint32_t, std::uint32_t>;

Edge edgeOf(std::uint32_t a, std::uint32_t b) {
    return {std::min(a, b), std::max(a, b)};
}

// How many edges have 1, 2, 3 ... faces at them.
std::map<int, std::size_t> histogram(const std::map<Edge, int>& edges) {
    std::map<int, std::size_t> counts;
    for (const auto& [edge, faces] : edges) ++counts[faces];
    return counts;
}

struct CageTopology {
    std::map<Edge, int> edges;
    std::set<std::uint32_t> vertices;
    std::size_t faces = 0;
};

CageTopology topologyOf(const SubdivisionCage& cage) {
    CageTopology topology;
    std::size_t first = 0;
    for (std::uint32_t face = 0; face < cage.mesh.faceCount(); ++face) {
        const std::uint32_t size = cage.mesh.faceVertexCounts[face];
        const bool hole = std::count(cage.holes.begin(), cage.holes.end(), face) != 0;
        for (std::uint32_t i = 0; i < size && !hole; ++i) {
            const std::uint32_t vertex = cage.mesh.vertexIndices[first + i];
            topology.vertices.insert(vertex);
            ++topology.edges[edgeOf(vertex, cage.mesh.vertexIndices[first + (i + 1) % size])];
        }
        topology.faces += hole ? 0 : 1;
        first += size;
    }
    return topology;
}

std::map<Edge, int> triangleEdges(const TriangleMesh& mesh) {
    std::map<Edge, int> edges;
    for (const TriangleMesh::Corners& t : mesh.triangles) {
        for (std::size_t i = 0; i < 3; ++i) ++edges[edgeOf(t[i], t[(i + 1) % 3])];
    }
    return edges;
}

// Every edge of the cage becomes `rate` edges with as many triangles as it had faces; all others
// lie inside a face and have two. And vertices - edges + faces is that of the cage.
void expectNoCracks(const SubdivisionCage& cage, const TriangleMesh& mesh, int rate) {
    const CageTopology topology = topologyOf(cage);
    const std::map<Edge, int> edges = triangleEdges(mesh);
    std::map<int, std::size_t> expected = histogram(topology.edges), got = histogram(edges);
    expected.erase(2);
    got.erase(2);
    for (auto& [faces, count] : expected) count *= static_cast<std::size_t>(rate);
    EXPECT_EQ(got, expected);
    const auto euler = [](std::size_t v, std::size_t e, std::size_t f) {
        return static_cast<long>(v) - static_cast<long>(e) + static_cast<long>(f);
    };
    EXPECT_EQ(euler(mesh.positions.size(), edges.size(), mesh.triangles.size()),
              euler(topology.vertices.size(), topology.edges.size(), topology.faces));
}

void expectSound(const SubdivisionCage& cage, const TriangleMesh& mesh) {
    for (const Vec3f& p : mesh.positions) ASSERT_TRUE(isFinite(p));
    for (const Vec3f& n : mesh.normals) ASSERT_NEAR(length(n), 1, 1e-5f);
    for (const Vec2f& t : mesh.texcoords) ASSERT_TRUE(std::isfinite(t.x) && std::isfinite(t.y));
    ASSERT_EQ(mesh.normalIndices.size(), mesh.triangles.size());
    ASSERT_EQ(mesh.materials.size(), mesh.triangles.size());
    ASSERT_EQ(mesh.faces.size(), mesh.triangles.size());
    ASSERT_EQ(mesh.texcoordIndices.size(),
              cage.mesh.texcoordIndices.empty() ? 0 : mesh.triangles.size());
    std::vector<bool> used(mesh.positions.size());
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        for (std::size_t corner = 0; corner < 3; ++corner) {
            ASSERT_LT(mesh.triangles[i][corner], mesh.positions.size());
            ASSERT_LT(mesh.normalIndices[i][corner], mesh.normals.size());
            used[mesh.triangles[i][corner]] = true;
        }
    }
    ASSERT_EQ(std::count(used.begin(), used.end(), false), 0);
}

TEST(Tessellate, NoShapeCracks) {
    auto files = test::objFiles(PM_SHARED_DATA "/subdiv");
    if (files.empty()) GTEST_SKIP() << "no shared data";
    for (const auto& file : files) {
        const SubdivisionCage cage = test::readObjCage(file);
        for (const int rate : {1, 2, 3, 4, 7}) {
            SCOPED_TRACE(file.filename().string() + " at rate " + std::to_string(rate));
            const BuiltMesh built = tessellate(cage, rate);
            expectSound(cage, built.mesh);
            EXPECT_EQ(built.repairs.ignoredCreases, 0u);
            // The first leaves faces out, the second has faces that meet a vertex twice.
            if (cage.boundary == BoundaryInterpolation::kNone ||
                file.stem() == "catmark_nonman_quadpole64")
                continue;
            // Uncut faces back to back have the same diagonal, and so four triangles at it.
            if (file.stem() == "catmark_val2_interior" && rate == 1) continue;
            expectNoCracks(cage, built.mesh, rate);
            EXPECT_EQ(built.mesh.triangles.size(), tessellationSize(cage, rate).triangles);
        }
    }
}

TEST(Tessellate, CubesAreClosedAtAnyRate) {
    for (const int rate : {1, 2, 3, 4, 7, 32}) {
        const TriangleMesh mesh = tessellate(test::cubeCage(), rate).mesh;
        EXPECT_EQ(mesh.triangles.size(), static_cast<std::size_t>(12 * rate * rate));
        for (const auto& [edge, faces] : triangleEdges(mesh)) ASSERT_EQ(faces, 2);
    }
}

TEST(Tessellate, SizeIsKnownBeforehand) {
    const SubdivisionCage cage = test::gridCage(10);
    for (const int rate : {1, 5, 16}) {
        const TessellationSize size = tessellationSize(cage, rate);
        const TriangleMesh mesh = tessellate(cage, rate).mesh;
        EXPECT_EQ(size.triangles, mesh.triangles.size());
        const std::size_t bytes =
            (mesh.positions.size() + mesh.normals.size()) * sizeof(Vec3f) +
            (mesh.triangles.size() + mesh.normalIndices.size()) * sizeof(TriangleMesh::Corners) +
            (mesh.materials.size() + mesh.faces.size()) * sizeof(std::uint32_t);
        EXPECT_GE(size.bytes, bytes);
        EXPECT_LE(size.bytes, 2 * bytes);
    }
}

TEST(Tessellate, HolesAndUnusedVerticesAreLeftOut) {
    SubdivisionCage cage = test::gridCage(3);
    cage.mesh.positions.emplace_back(9.0f, 9.0f, 9.0f);
    cage.holes = {4, 4};
    const TriangleMesh mesh = tessellate(cage, 2).mesh;
    EXPECT_EQ(mesh.triangles.size(), 8u * 8);
    EXPECT_EQ(tessellationSize(cage, 2).triangles, 8u * 8);
    for (const std::uint32_t face : mesh.faces) EXPECT_NE(face, 4u);
    for (const Vec3f& p : mesh.positions) EXPECT_LT(p.z, 1);
    expectSound(cage, mesh);
}

TEST(Tessellate, ThreadsChangeNothing) {
    SubdivisionCage cage = test::gridCage(30);
    std::mt19937 random(3);
    for (Vec3f& p : cage.mesh.positions) p.z = static_cast<float>(random() % 100) * 0.01f;
    // Triangles among the quads, so that many faces are irregular.
    for (std::size_t face = 0; face < 900; face += 7) cage.mesh.faceVertexCounts[face] = 0;
    SubdivisionCage mixed;
    mixed.mesh.positions = cage.mesh.positions;
    for (std::size_t face = 0; face < 900; ++face) {
        const std::uint32_t* v = &cage.mesh.vertexIndices[4 * face];
        const bool split = cage.mesh.faceVertexCounts[face] == 0;
        std::vector<std::uint32_t>& counts = mixed.mesh.faceVertexCounts;
        std::vector<std::uint32_t>& indices = mixed.mesh.vertexIndices;
        counts.insert(counts.end(), split ? 2 : 1, split ? 3 : 4);
        if (split) indices.insert(indices.end(), {v[0], v[1], v[2], v[0], v[2], v[3]});
        if (!split) indices.insert(indices.end(), v, v + 4);
    }
    const tbb::global_control allowed(tbb::global_control::max_allowed_parallelism, 8);
    const auto build = [&](int threads) {
        BuiltMesh built;
        tbb::task_arena(threads).execute([&] { built = tessellate(mixed, 3); });
        return built.mesh;
    };
    const TriangleMesh one = build(1);
    for (const int threads : {2, 8}) {
        const TriangleMesh many = build(threads);
        ASSERT_EQ(one.triangles, many.triangles);
        ASSERT_EQ(one.normalIndices, many.normalIndices);
        ASSERT_EQ(one.positions.size(), many.positions.size());
        ASSERT_EQ(one.normals.size(), many.normals.size());
        EXPECT_EQ(std::memcmp(one.positions.data(), many.positions.data(),
                              one.positions.size() * sizeof(Vec3f)),
                  0);
        EXPECT_EQ(std::memcmp(one.normals.data(), many.normals.data(),
                              one.normals.size() * sizeof(Vec3f)),
                  0);
    }
}

TEST(Tessellate, CreasesThatAreNoEdgesAreCounted) {
    SubdivisionCage cage = test::cubeCage();
    cage.creases = {{{0, 7}, 3}, {{0, 0}, 3}, {{0, 1}, 3}};
    EXPECT_EQ(tessellate(cage, 1).repairs.ignoredCreases, 2u);
}

// A face shrunk to a point has no tangents; its normals still have to be unit vectors.
TEST(Tessellate, CollapsedCagesHaveNormals) {
    SubdivisionCage cage = test::cubeCage();
    for (std::size_t i = 4; i < 8; ++i) cage.mesh.positions[i] = {0, 0, 1};
    expectSound(cage, tessellate(cage, 3).mesh);
    for (Vec3f& p : cage.mesh.positions) p = {1, 2, 3};
    const BuiltMesh point = tessellate(cage, 3);
    expectSound(cage, point.mesh);
    EXPECT_GT(point.repairs.replacedNormals, 0u);
}

// Three pages at a spine, and two pyramids that touch in a point: cut open inside, but not in the
// mesh.
TEST(Tessellate, CagesThatAreNoSurfaceStayTogether) {
    const SubdivisionCage book = test::parseObjCage(
        "v 0 0 0\nv 0 1 0\nv 0 2 0\nv 1 0 0\nv 1 1 0\nv 1 2 0\nv -1 0 0\nv -1 1 0\nv -1 2 0\n"
        "v 0 0 1\nv 0 1 1\nv 0 2 1\n"
        "f 1 4 5 2\nf 2 5 6 3\nf 1 7 8 2\nf 2 8 9 3\nf 1 10 11 2\nf 2 11 12 3\n");
    const SubdivisionCage cones = test::parseObjCage(
        "v 0 0 0\nv 1 0 1\nv 0 1 1\nv -1 -1 1\nv 1 0 -1\nv 0 1 -1\nv -1 -1 -1\n"
        "f 1 2 3\nf 1 3 4\nf 1 4 2\nf 1 6 5\nf 1 7 6\nf 1 5 7\n");
    for (const SubdivisionCage& cage : {book, cones}) {
        const TriangleMesh mesh = tessellate(cage, 3).mesh;
        expectSound(cage, mesh);
        expectNoCracks(cage, mesh, 3);
        // The end of the spine and the common tip are where the cage has them.
        EXPECT_NE(std::count(mesh.positions.begin(), mesh.positions.end(), Vec3f(0, 0, 0)), 0);
    }
}

// A vertex of two faces next to a crease: OpenSubdiv would read outside its arrays.
TEST(Tessellate, VerticesOfTwoFacesNearCreasesAreOpened) {
    SubdivisionCage pillow =
        test::parseObjCage("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\nf 4 3 2 1\n");
    EXPECT_EQ(tessellate(pillow, 2).repairs.openedVertices, 0u);
    pillow.creases = {{{0, 1}, 2}};
    const BuiltMesh built = tessellate(pillow, 2);
    EXPECT_EQ(built.repairs.openedVertices, 4u);
    expectSound(pillow, built.mesh);
    expectNoCracks(pillow, built.mesh, 2);
}

std::string refusal(const SubdivisionCage& cage, int rate = 2) {
    try {
        tessellate(cage, rate);
    } catch (const Error& error) {
        return error.what();
    }
    return {};
}

TEST(Tessellate, BadFeaturesAreRefused) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const float infinity = std::numeric_limits<float>::infinity();
    SubdivisionCage cage = test::cubeCage();
    cage.creases = {{{0, 8}, 1}};
    EXPECT_EQ(refusal(cage), "crease 0 refers to vertex 8 of 8");
    for (const float bad : {nan, infinity, -1.0f}) {
        cage.creases = {{{0, 1}, bad}};
        EXPECT_NE(refusal(cage).find("crease 0 has sharpness"), std::string::npos);
        cage.creases.clear();
        cage.corners = {{3, bad}};
        EXPECT_NE(refusal(cage).find("corner 0 has sharpness"), std::string::npos);
        cage.corners.clear();
    }
    cage.corners = {{0xffffffffu, 1}};
    EXPECT_EQ(refusal(cage), "corner 0 refers to vertex 4294967295 of 8");
    cage.corners.clear();
    cage.holes = {6};
    EXPECT_EQ(refusal(cage), "hole 0 refers to face 6 of 6");
    cage.holes.clear();
    cage.mesh.vertexIndices[5] = 0xffffffffu;
    EXPECT_EQ(refusal(cage), "face 1 refers to vertex 4294967295 of 8");
    cage = test::cubeCage();
    cage.mesh.texcoords = {{0, 0}};
    cage.mesh.texcoordIndices.assign(24, 0);
    cage.mesh.texcoordIndices[7] = 1;
    EXPECT_EQ(refusal(cage), "face 1 refers to texture coordinate 1 of 1");
    cage.mesh.texcoordIndices[7] = -1;
    EXPECT_EQ(refusal(cage), "");
    cage.scheme = SubdivisionScheme::kLoop;
    EXPECT_EQ(refusal(cage), "face 0 has 4 corners; Loop subdivision wants triangles");
}

TEST(Tessellate, RatesAreBounded) {
    for (const int rate : {-1, 0, kMaxTessellationRate + 1}) {
        EXPECT_NE(refusal(test::cubeCage(), rate).find("tessellation rate is"), std::string::npos);
    }
    SubdivisionCage cage;
    cage.mesh.positions.resize(65535);
    cage.mesh.faceVertexCounts = {65535};
    for (std::uint32_t i = 0; i < 65535; ++i) cage.mesh.vertexIndices.push_back(i);
    EXPECT_THROW(tessellationSize(cage, kMaxTessellationRate), Error);
}

TEST(Tessellate, TooManyFacesAtAVertexAreRefused) {
    SubdivisionCage cage;
    cage.mesh.positions.resize(70001);
    for (std::uint32_t i = 1; i <= 70000; ++i) {
        cage.mesh.faceVertexCounts.push_back(3);
        cage.mesh.vertexIndices.insert(cage.mesh.vertexIndices.end(), {0, i, i % 70000 + 1});
    }
    EXPECT_EQ(refusal(cage),
              "vertex 0 has 70000 faces and 70000 edges; subdivision takes at most 65535");
}

// Any indices in range: repeated corners, faces on top of each other, edges with many faces, turned
// over. Whatever comes out must be sound.
TEST(Tessellate, RandomTopologyNeverCrashes) {
    std::mt19937 random(4);
    for (int i = 0; i < 400; ++i) {
        SubdivisionCage cage;
        const std::uint32_t vertices = 4 + static_cast<std::uint32_t>(random() % 12);
        for (std::uint32_t v = 0; v < vertices; ++v) {
            cage.mesh.positions.emplace_back(static_cast<float>(random() % 10),
                                             static_cast<float>(random() % 10),
                                             static_cast<float>(random() % 10));
        }
        cage.mesh.texcoords = {{0, 0}, {1, 0}, {0, 1}};
        cage.scheme = static_cast<SubdivisionScheme>(random() % 3);
        cage.boundary = static_cast<BoundaryInterpolation>(random() % 3);
        cage.faceVarying = static_cast<FaceVaryingInterpolation>(random() % 6);
        const auto faces = 1 + static_cast<std::uint32_t>(random() % 12);
        for (std::uint32_t f = 0; f < faces; ++f) {
            const bool loop = cage.scheme == SubdivisionScheme::kLoop;
            const auto size = loop ? 3 : 3 + static_cast<std::uint32_t>(random() % 4);
            cage.mesh.faceVertexCounts.push_back(size);
            for (std::uint32_t c = 0; c < size; ++c) {
                cage.mesh.vertexIndices.push_back(static_cast<std::uint32_t>(random() % vertices));
                cage.mesh.texcoordIndices.push_back(static_cast<std::int32_t>(random() % 4) - 1);
            }
        }
        for (int k = 0; k < 3; ++k) {
            const auto any = [&] { return static_cast<std::uint32_t>(random() % vertices); };
            cage.creases.push_back({{any(), any()}, static_cast<float>(random() % 12)});
            cage.corners.push_back({any(), static_cast<float>(random() % 12)});
        }
        SCOPED_TRACE(i);
        try {
            expectSound(cage, tessellate(cage, 1 + i % 4).mesh);
        } catch (const Error& error) {
            EXPECT_EQ(error.status(), Status::kInvalidScene);
        }
        if (HasFailure()) break;
    }
}

}  // namespace
}  // namespace pm
