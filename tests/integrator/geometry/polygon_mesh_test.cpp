// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/geometry/polygon_mesh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "integrator/geometry/triangulate.h"
#include "integrator/values/error.h"
#include "tests/integrator/geometry/obj_cage.h"

namespace pm {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

PolygonMesh square() {
    return test::gridCage(1).mesh;
}

// The text of the error that a mesh is refused with; empty when it is accepted.
std::string refusal(const PolygonMesh& mesh) {
    try {
        validate(mesh);
    } catch (const Error& error) {
        EXPECT_EQ(error.status(), Status::kInvalidScene);
        return error.what();
    }
    return {};
}

TEST(PolygonMesh, GoodMeshesPass) {
    EXPECT_EQ(refusal(square()), "");
    EXPECT_EQ(refusal(PolygonMesh{}), "");
    PolygonMesh mesh = square();
    mesh.normalIndices = {-1, -1, -1, -1};
    EXPECT_EQ(refusal(mesh), "");
}

TEST(PolygonMesh, IndicesOutOfRangeAreNamed) {
    PolygonMesh mesh = square();
    mesh.vertexIndices[2] = 9001;
    EXPECT_EQ(refusal(mesh), "face 0 refers to vertex 9001 of 4");
    mesh.vertexIndices[2] = 4;
    EXPECT_EQ(refusal(mesh), "face 0 refers to vertex 4 of 4");
    mesh.vertexIndices[2] = 0xffffffffu;
    EXPECT_EQ(refusal(mesh), "face 0 refers to vertex 4294967295 of 4");

    mesh = square();
    mesh.normals = {{0, 0, 1}};
    mesh.normalIndices = {0, 0, 0, 1};
    EXPECT_EQ(refusal(mesh), "face 0 refers to normal 1 of 1");
    mesh.normalIndices = {0, 0, 0, -2};
    EXPECT_EQ(refusal(mesh), "face 0 refers to normal -2 of 1");

    mesh = square();
    mesh.texcoordIndices = {-1, 0, -1, -1};
    EXPECT_EQ(refusal(mesh), "face 0 refers to texture coordinate 0 of 0");
}

TEST(PolygonMesh, SizesMustFit) {
    PolygonMesh mesh = square();
    mesh.faceVertexCounts = {2, 2};
    EXPECT_EQ(refusal(mesh), "face 0 has 2 corners; it must have 3 to 65535");
    mesh.faceVertexCounts = {65536};
    EXPECT_EQ(refusal(mesh), "face 0 has 65536 corners; it must have 3 to 65535");
    mesh.faceVertexCounts = {5};
    EXPECT_EQ(refusal(mesh), "there are 4 vertex indices, but the faces have 5 corners in all");
    mesh = square();
    mesh.normalIndices = {-1};
    EXPECT_EQ(refusal(mesh), "there are 1 normal indices, but the faces have 4 corners in all");
    mesh = square();
    mesh.faceMaterials = {0, 1};
    EXPECT_EQ(refusal(mesh), "there are 2 material slots for 1 faces");
}

TEST(PolygonMesh, NumbersMustBeFinite) {
    for (const float bad : {kNan, kInfinity, -kInfinity, 2e18f}) {
        PolygonMesh mesh = square();
        mesh.positions[1].y = bad;
        EXPECT_NE(refusal(mesh), "") << bad;
    }
    PolygonMesh mesh = square();
    mesh.texcoords = {{0, kNan}};
    EXPECT_EQ(refusal(mesh), "texture coordinate 0 is (0, nan); it must be finite");
}

TEST(Triangulate, RefusesWhatValidateRefuses) {
    PolygonMesh mesh = square();
    mesh.vertexIndices[0] = 4;
    EXPECT_THROW(triangulate(mesh), Error);
}

TEST(Triangulate, TrianglesWithoutAreaAreDroppedAndCounted) {
    PolygonMesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0, 1, 0}};
    mesh.faceVertexCounts = {3, 3, 3};
    mesh.vertexIndices = {0, 1, 2, 0, 1, 3, 1, 1, 3};
    const BuiltMesh built = triangulate(mesh);
    EXPECT_EQ(built.repairs.droppedTriangles, 2u);
    ASSERT_EQ(built.mesh.triangles.size(), 1u);
    EXPECT_EQ(built.mesh.faces[0], 1u);
    EXPECT_EQ(built.mesh.triangles[0], (TriangleMesh::Corners{0, 1, 3}));
}

TEST(Triangulate, BadNormalsBecomeThatOfThePolygon) {
    PolygonMesh mesh = square();
    // Turned round: its normal is not the one that stands for none.
    std::ranges::reverse(mesh.vertexIndices);
    mesh.normals = {{0, 0, 0}, {kNan, 0, 0}, {3, 0, 4}};
    mesh.normalIndices = {0, 1, 2, -1};
    const BuiltMesh built = triangulate(mesh);
    EXPECT_EQ(built.repairs.replacedNormals, 2u);
    ASSERT_EQ(built.mesh.normalIndices.size(), 2u);
    for (std::size_t i = 0; i < 2; ++i) {
        for (std::size_t corner = 0; corner < 3; ++corner) {
            const Vec3f normal = built.mesh.normals[built.mesh.normalIndices[i][corner]];
            const bool given = built.mesh.triangles[i][corner] == mesh.vertexIndices[2];
            EXPECT_EQ(normal, given ? Vec3f(0.6f, 0, 0.8f) : Vec3f(0, 0, -1));
        }
    }
    for (const Vec3f& normal : built.mesh.normals) EXPECT_NEAR(length(normal), 1, 1e-6f);
}

TEST(Triangulate, AttributesFollowTheirCorners) {
    PolygonMesh mesh = test::gridCage(2).mesh;
    mesh.faceMaterials = {7, 8, 9, 10};
    for (const Vec3f& p : mesh.positions) mesh.texcoords.push_back({p.x, p.y});
    mesh.texcoordIndices.assign(mesh.vertexIndices.begin(), mesh.vertexIndices.end());
    mesh.texcoordIndices[0] = -1;  // vertex 0 of the first face
    const TriangleMesh built = triangulate(mesh).mesh;
    ASSERT_EQ(built.triangles.size(), 8u);
    EXPECT_TRUE(built.normals.empty());
    for (std::size_t i = 0; i < 8; ++i) {
        EXPECT_EQ(built.materials[i], 7 + built.faces[i]);
        for (std::size_t corner = 0; corner < 3; ++corner) {
            const Vec3f& p = built.positions[built.triangles[i][corner]];
            EXPECT_EQ(built.texcoords[built.texcoordIndices[i][corner]], (Vec2f{p.x, p.y}));
        }
    }
}

}  // namespace
}  // namespace pm
