// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Tangents of meshes: which corners are one, what counts for how much there, and what they are
// where texture coordinates are mirrored, split or without area.
#include "integrator/shapes/tangents.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace pm::test {
namespace {

void expectNear(const Vec3f& found, const Vec3f& right) {
    for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(found[axis], right[axis], 1e-6f) << axis;
}

using Corners = TriangleMesh::Corners;

// Triangles on the ground, seen from above (y up), with one normal for all; a texture coordinate
// beside each position.
TriangleMesh ground(std::vector<Vec3f> positions, std::vector<Vec2f> uvs,
                    std::vector<Corners> triangles) {
    TriangleMesh mesh;
    mesh.positions = std::move(positions);
    mesh.texcoords = std::move(uvs);
    mesh.triangles = std::move(triangles);
    mesh.texcoordIndices = mesh.triangles;
    mesh.normals = {{0, 1, 0}};
    mesh.normalIndices.assign(mesh.triangles.size(), Corners{0, 0, 0});
    return mesh;
}

// Two right-angled triangles beside each other on an edge from (0, 0, 0) to (0, 0, -1): the left
// one has u along x, the right one's u runs as asked.
TriangleMesh pair(const Vec2f& farCorner) {
    return ground({{0, 0, 0}, {0, 0, -1}, {-1, 0, 0}, {1, 0, 0}},
                  {{0, 0}, {0, 1}, {-1, 0}, farCorner}, {{0, 1, 2}, {0, 3, 1}});
}

TEST(Tangents, PointWhereUGrows) {
    const Tangents tangents(pair({1, 0}));
    for (std::uint32_t t = 0; t < 2; ++t)
        for (std::size_t k = 0; k < 3; ++k) expectNear(tangents.at(t, k), {1, 0, 0});
    EXPECT_FALSE(tangents.isMirrored(0));
    EXPECT_FALSE(tangents.isMirrored(1));
}

// The right one's u turns by 45 degrees: with (u, v) of its far corner (1, -1) v stays along -z and
// u is along x - z. At the shared edge's corners angles of 90 and 90, and 45 and 45 degrees count.
TEST(Tangents, AreAveragedWhereCornersAreOne) {
    const Tangents tangents(pair({1, 1}));
    const float s = std::sqrt(0.5f);
    // u grows along x there: of e1 = (1,0,0), d1 = (1,1) and e2 = (0,0,-1), d2 = (0,1) the
    // derivative by u is (1,0,0) - (0,0,-1).
    const Vec3f right{s, 0, s};
    const Vec3f mean = normalize(Vec3f{1, 0, 0} + right);
    expectNear(tangents.at(0, 2), {1, 0, 0});
    expectNear(tangents.at(1, 1), right);
    for (const std::size_t k : {0u, 1u}) expectNear(tangents.at(0, k), mean);
    expectNear(tangents.at(1, 0), mean);
    expectNear(tangents.at(1, 2), mean);
}

TEST(Tangents, CountByAngles) {
    // The right one is cut to half its angle at the corner (0, 0, 0): 45 degrees beside 90.
    const TriangleMesh mesh = ground({{0, 0, 0}, {0, 0, -1}, {-1, 0, 0}, {1, 0, -1}},
                                     {{0, 0}, {0, 1}, {-1, 0}, {1, 2}}, {{0, 1, 2}, {0, 3, 1}});
    const Tangents tangents(mesh);
    const float s = std::sqrt(0.5f);
    const Vec3f right{s, 0, s};
    expectNear(tangents.at(0, 0), normalize(Vec3f{1, 0, 0} * 2.0f + right));
    // At (0, 0, -1) 45 degrees and 90.
    expectNear(tangents.at(0, 1), normalize(Vec3f{1, 0, 0} + right * 2.0f));
}

// The two halves of a symmetric model: u runs away from the seam on both sides.
TEST(Tangents, MirroredTextureCoordinatesAreSplit) {
    const Tangents tangents(pair({-1, 0}));
    EXPECT_FALSE(tangents.isMirrored(0));
    EXPECT_TRUE(tangents.isMirrored(1));
    for (std::size_t k = 0; k < 3; ++k) {
        expectNear(tangents.at(0, k), {1, 0, 0});
        expectNear(tangents.at(1, k), {-1, 0, 0});
    }
}

// At a seam of the texture nothing is averaged, though positions and normals are one.
TEST(Tangents, SeamsAreSplit) {
    TriangleMesh mesh = pair({1, 1});
    mesh.texcoords.push_back({0.5f, 0});
    mesh.texcoords.push_back({0.5f, 1});
    mesh.texcoords[3] = {1.5f, 1};
    mesh.texcoordIndices[1] = {4, 3, 5};
    const Tangents tangents(mesh);
    const float s = std::sqrt(0.5f);
    for (std::size_t k = 0; k < 3; ++k) {
        expectNear(tangents.at(0, k), {1, 0, 0});
        expectNear(tangents.at(1, k), {s, 0, s});
    }
}

// Where normals have an edge so do tangents; and each lies at right angles to its own.
TEST(Tangents, EdgesOfNormalsAreSplit) {
    TriangleMesh mesh = pair({1, 1});
    const Vec3f leaning = normalize(Vec3f{1, 1, 0});
    mesh.normals.push_back(leaning);
    mesh.normalIndices[1] = {1, 1, 1};
    const Tangents tangents(mesh);
    for (std::size_t k = 0; k < 3; ++k) {
        expectNear(tangents.at(0, k), {1, 0, 0});
        EXPECT_NEAR(dot(tangents.at(1, k), leaning), 0.0f, 1e-6f);
        EXPECT_NEAR(length(tangents.at(1, k)), 1.0f, 1e-6f);
    }
}

// The same numbers under other indices are the same corner: files repeat them.
TEST(Tangents, CornersAreOneByValue) {
    TriangleMesh repeated = pair({1, 1});
    repeated.positions.push_back({0, -0.0f, 0});
    repeated.positions.push_back({0, 0, -1});
    repeated.texcoords.push_back({0, 0});
    repeated.texcoords.push_back({0, 1});
    repeated.triangles[1] = repeated.texcoordIndices[1] = {4, 3, 5};
    const Tangents one(pair({1, 1})), other(repeated);
    for (std::uint32_t t = 0; t < 2; ++t)
        for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(one.at(t, k), other.at(t, k));
}

// Two triangles that touch in a corner alone share no tangent.
TEST(Tangents, CornersWithoutACommonEdgeAreSplit) {
    const TriangleMesh mesh =
        ground({{0, 0, 0}, {-1, 0, 1}, {-1, 0, 0}, {1, 0, 0}, {0, 0, -1}},
               {{0, 0}, {-1, -1}, {-1, 0}, {1, 1}, {0, 1}}, {{0, 2, 1}, {0, 3, 4}});
    const Tangents tangents(mesh);
    const float s = std::sqrt(0.5f);
    expectNear(tangents.at(0, 0), {1, 0, 0});
    expectNear(tangents.at(1, 0), {s, 0, s});
}

// Without area a triangle's texture coordinates say nothing: it goes with its neighbours, mirrored
// or not, and changes nothing there.
TEST(Tangents, DegenerateTextureCoordinatesGoWithTheirNeighbours) {
    const Tangents straight(pair({0, 0.5f}));
    for (const std::size_t k : {0u, 2u}) expectNear(straight.at(1, k), {1, 0, 0});
    EXPECT_FALSE(straight.isMirrored(1));
    // Nobody reaches its far corner.
    expectNear(straight.at(1, 1), {0, 0, 0});

    TriangleMesh mirrored = pair({0, 0.5f});
    mirrored.texcoords[2] = {1, 0};
    const Tangents tangents(mirrored);
    EXPECT_TRUE(tangents.isMirrored(0));
    EXPECT_TRUE(tangents.isMirrored(1));
    expectNear(tangents.at(1, 0), {-1, 0, 0});
}

TEST(Tangents, WithoutAnyAreaThereAreNone) {
    for (const Vec2f& far : {Vec2f{0, 0}, Vec2f{0, 2}}) {
        TriangleMesh mesh = pair({0, 0.5f});
        mesh.texcoords[2] = far;
        const Tangents tangents(mesh);
        for (std::uint32_t t = 0; t < 2; ++t)
            for (std::size_t k = 0; k < 3; ++k) expectNear(tangents.at(t, k), {0, 0, 0});
    }
    // Nor where the triangle itself is a point.
    TriangleMesh point = pair({1, 0});
    point.positions.assign(4, Vec3f{1, 1, 1});
    expectNear(Tangents(point).at(0, 0), {0, 0, 0});
}

// A mesh without normals has those of its triangles: flat ones share, a folded edge splits.
TEST(Tangents, OfAMeshWithoutNormals) {
    TriangleMesh flat = pair({1, 1});
    flat.normals.clear();
    flat.normalIndices.clear();
    TriangleMesh folded = flat;
    folded.positions[3] = {1, 1, 0};
    const float s = std::sqrt(0.5f);
    expectNear(Tangents(flat).at(0, 0), normalize(Vec3f{1, 0, 0} + Vec3f{s, 0, s}));
    expectNear(Tangents(folded).at(0, 0), {1, 0, 0});
}

// A globe with u around: at every vertex u grows eastwards, whatever the triangles.
TEST(Tangents, OfAGlobe) {
    constexpr int kRings = 8, kAround = 12;
    TriangleMesh mesh;
    for (int ring = 0; ring <= kRings; ++ring)
        for (int i = 0; i <= kAround; ++i) {
            const double theta = std::numbers::pi * (ring + 1) / (kRings + 2),
                         phi = 2 * std::numbers::pi * i / kAround;
            mesh.positions.emplace_back(Vec3d{std::sin(theta) * std::cos(phi), std::cos(theta),
                                              -std::sin(theta) * std::sin(phi)});
            mesh.texcoords.push_back(
                {static_cast<float>(i) / kAround, 1.0f - static_cast<float>(ring) / kRings});
        }
    mesh.normals = mesh.positions;
    for (std::uint32_t ring = 0; ring < kRings; ++ring)
        for (std::uint32_t i = 0; i < kAround; ++i) {
            const std::uint32_t a = ring * (kAround + 1) + i, b = a + kAround + 1;
            mesh.triangles.push_back({a, b, b + 1});
            mesh.triangles.push_back({a, b + 1, a + 1});
        }
    mesh.texcoordIndices = mesh.normalIndices = mesh.triangles;
    const Tangents tangents(mesh);
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
        for (std::size_t k = 0; k < 3; ++k) {
            const std::uint32_t vertex = mesh.triangles[t][k];
            const std::uint32_t around = vertex % (kAround + 1);
            // At the seam only one side's triangles count.
            if (around == 0 || around == kAround) continue;
            const double phi = 2 * std::numbers::pi * around / kAround;
            const Vec3f east(Vec3d{-std::sin(phi), 0, -std::cos(phi)});
            EXPECT_GT(dot(tangents.at(t, k), east), 0.97f);
            EXPECT_NEAR(dot(tangents.at(t, k), mesh.normals[vertex]), 0.0f, 1e-6f);
            EXPECT_FALSE(tangents.isMirrored(t));
        }
}

TEST(Tangents, AreMadeOnce) {
    const TriangleMesh mesh = pair({1, 0});
    EXPECT_EQ(Tangents::of(mesh), Tangents::of(mesh));
}

}  // namespace
}  // namespace pm::test
