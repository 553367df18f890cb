// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Where the limit surface lies, against closed forms and against refinements by another
// implementation (Hbr), whose refined meshes are taken to the limit by the closed form.
#include "integrator/geometry/subdivision.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "integrator/geometry/triangulate.h"
#include "tests/integrator/geometry/obj_cage.h"

namespace pm {
namespace {

double distanceToNearest(const Vec3d& point, const std::vector<Vec3f>& points) {
    double best = 1e300;
    for (const Vec3f& p : points) best = std::min(best, lengthSquared(Vec3d(p) - point));
    return std::sqrt(best);
}

// Limit position of each vertex of an all-quad mesh without creases. Interior vertex of valence m:
// (m^2 v + 4 sum(e) + sum(f)) / (m (m + 5)); boundary: (e1 + 4 v + e2) / 6.
std::vector<Vec3d> limitOfQuads(const PolygonMesh& mesh, bool sharpCorners) {
    const std::size_t count = mesh.positions.size();
    std::vector<Vec3d> opposite(count), limit(count);
    std::vector<int> faces(count, 0);
    std::vector<std::map<std::uint32_t, int>> neighbours(
        count);  // and how many faces have that edge
    for (std::size_t face = 0; face < mesh.faceCount(); ++face) {
        const std::uint32_t* v = &mesh.vertexIndices[4 * face];
        for (std::size_t i = 0; i < 4; ++i) {
            ++faces[v[i]];
            opposite[v[i]] += Vec3d(mesh.positions[v[(i + 2) % 4]]);
            ++neighbours[v[i]][v[(i + 1) % 4]];
            ++neighbours[v[i]][v[(i + 3) % 4]];
        }
    }
    for (std::size_t i = 0; i < count; ++i) {
        const Vec3d v(mesh.positions[i]);
        Vec3d edges, boundary;
        bool onBoundary = false;
        for (const auto& [other, uses] : neighbours[i]) {
            edges += Vec3d(mesh.positions[other]);
            if (uses != 1) continue;
            boundary += Vec3d(mesh.positions[other]);
            onBoundary = true;
        }
        const double m = faces[i];
        limit[i] = onBoundary ? (boundary + v * 4.0) / 6.0
                              : (v * (m * m) + edges * 4.0 + opposite[i]) / (m * (m + 5));
        if (onBoundary && sharpCorners && faces[i] == 1) limit[i] = v;
    }
    return limit;
}

bool allQuads(const PolygonMesh& mesh) {
    return std::all_of(mesh.faceVertexCounts.begin(), mesh.faceVertexCounts.end(),
                       [](std::uint32_t size) { return size == 4; });
}

float sharpest(const SubdivisionCage& cage) {
    float sharpness = 0;
    for (const Crease& crease : cage.creases) sharpness = std::max(sharpness, crease.sharpness);
    for (const SharpCorner& corner : cage.corners)
        sharpness = std::max(sharpness, corner.sharpness);
    return sharpness;
}

TEST(LimitSurface, CubeCornersGoHalfWay) {
    const TriangleMesh mesh = tessellate(test::cubeCage(), 1).mesh;
    ASSERT_EQ(mesh.positions.size(), 8u);
    for (const Vec3f& p : mesh.positions) {
        for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(std::abs(p[axis]), 0.5, 1e-6);
    }
}

// Refining the cube by hand must not move its limit: the second, third ... cage has the same one.
// Its points at rate 8 are the limits of the vertices of 3 refinements by Hbr.
TEST(LimitSurface, HbrRefinementsHaveTheSameLimit) {
    const auto files = test::objFiles(PM_SHARED_DATA "/subdiv");
    if (files.empty()) GTEST_SKIP() << "no shared data";
    int compared = 0;
    for (const std::filesystem::path& file : files) {
        const SubdivisionCage cage = test::readObjCage(file);
        const std::string name = file.stem().string();
        const std::filesystem::path refinedFile =
            std::string(PM_SHARED_DATA "/subdiv-hbr/") + name + "_level2.obj";
        // Creases up to 3 are gone after 3 refinements; chaikin1 and flap have older rules.
        if (cage.scheme != SubdivisionScheme::kCatmullClark || !allQuads(cage.mesh) ||
            sharpest(cage) > 3 || name == "catmark_chaikin1" ||
            !std::filesystem::exists(refinedFile))
            continue;
        const SubdivisionCage refined = test::readObjCage(refinedFile);
        const TriangleMesh mesh = tessellate(cage, 8).mesh;
        const std::vector<Vec3d> limit =
            limitOfQuads(refined.mesh, cage.boundary == BoundaryInterpolation::kEdgeAndCorner);
        EXPECT_EQ(mesh.positions.size(), limit.size()) << name;
        double worst = 0;
        for (const Vec3d& p : limit) worst = std::max(worst, distanceToNearest(p, mesh.positions));
        EXPECT_LT(worst, 1e-5) << name;
        ++compared;
    }
    EXPECT_GE(compared, 8);
}

TEST(LimitSurface, BilinearSurfacesKeepTheirPoints) {
    SubdivisionCage cage = test::cubeCage();
    cage.scheme = SubdivisionScheme::kBilinear;
    const TriangleMesh mesh = tessellate(cage, 4).mesh;
    EXPECT_EQ(mesh.positions.size(), 8u + 12 * 3 + 6 * 9);
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        for (std::size_t corner = 0; corner < 3; ++corner) {
            EXPECT_FLOAT_EQ(maxAbsComponent(mesh.positions[mesh.triangles[i][corner]]), 1.0f);
            EXPECT_FLOAT_EQ(maxAbsComponent(mesh.normals[mesh.normalIndices[i][corner]]), 1.0f);
        }
    }
    EXPECT_EQ(mesh.normals.size(), 6u * 25) << "each side has its own normals";
}

TEST(LimitSurface, RegularGridsFollowTheirStencil) {
    SubdivisionCage cage = test::gridCage(4);
    cage.mesh.positions[12].z = 1;  // the middle
    cage.boundary = BoundaryInterpolation::kEdgeOnly;
    const TriangleMesh mesh = tessellate(cage, 1).mesh;
    const std::vector<Vec3d> expected = limitOfQuads(cage.mesh, false);
    for (const Vec3d& p : expected) EXPECT_LT(distanceToNearest(p, mesh.positions), 1e-6);
    const float highest =
        std::max_element(mesh.positions.begin(), mesh.positions.end(), [](Vec3f a, Vec3f b) {
            return a.z < b.z;
        })->z;
    EXPECT_NEAR(highest, 16.0 / 36, 1e-6);
}

TEST(LimitSurface, LoopSpheresAreRound) {
    SubdivisionCage cage;
    cage.scheme = SubdivisionScheme::kLoop;
    cage.mesh.positions = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
    cage.mesh.faceVertexCounts.assign(8, 3);
    cage.mesh.vertexIndices = {0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4,
                               2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5};
    const TriangleMesh mesh = tessellate(cage, 1).mesh;
    // Loop's limit mask with valence 4: beta = 31/256... by [Loop 1987], in Warren's closed form.
    const double c = 3.0 / 8 + std::cos(M_PI / 2) / 4;
    const double beta = (5.0 / 8 - c * c) / 4;
    const double chi = 1 / (3 / (8 * beta) + 4);
    for (const Vec3f& p : mesh.positions) EXPECT_NEAR(length(p), 1 - 4 * chi, 1e-6);
}

// The corner of a cube whose three edges never get smooth stays, with three normals of its own.
TEST(LimitSurface, InfiniteCreasesStaySharp) {
    SubdivisionCage cage = test::cubeCage();
    for (std::uint32_t a = 0; a < 8; ++a) {
        for (const std::uint32_t axis : {1u, 2u, 4u}) {
            if ((a & axis) == 0) cage.creases.push_back({{a, a | axis}, 10});
        }
    }
    const BuiltMesh built = tessellate(cage, 3);
    EXPECT_EQ(built.repairs.replacedNormals, 0u);
    std::map<std::uint32_t, std::set<std::uint32_t>> normalsOfPoint;
    for (std::size_t i = 0; i < built.mesh.triangles.size(); ++i) {
        for (std::size_t corner = 0; corner < 3; ++corner) {
            const std::uint32_t point = built.mesh.triangles[i][corner];
            const Vec3f normal = built.mesh.normals[built.mesh.normalIndices[i][corner]];
            normalsOfPoint[point].insert(built.mesh.normalIndices[i][corner]);
            EXPECT_NEAR(dot(built.mesh.positions[point], normal), 1, 1e-5);
            EXPECT_NEAR(maxAbsComponent(normal), 1, 1e-5);
        }
    }
    for (const auto& [point, normals] : normalsOfPoint) {
        const Vec3f& p = built.mesh.positions[point];
        const auto sides = static_cast<std::size_t>(
            (std::abs(p.x) > 0.999f) + (std::abs(p.y) > 0.999f) + (std::abs(p.z) > 0.999f));
        EXPECT_EQ(normals.size(), sides);
    }
}

// Semi-sharp creases and corners: the sharper, the nearer to the cage. Also vertex 0, once dropped.
TEST(LimitSurface, CornersPullTowardsTheCage) {
    double before = 0.5;
    for (const float sharpness : {0.5f, 1.0f, 2.0f, 4.0f, 20.0f}) {
        SubdivisionCage cage = test::cubeCage();
        cage.corners = {{0, sharpness}};
        const TriangleMesh mesh = tessellate(cage, 1).mesh;
        const double nearest = 1 - distanceToNearest(Vec3d(-1), mesh.positions) / std::sqrt(3.0);
        EXPECT_GT(nearest, before + 1e-4) << sharpness;
        before = nearest;
    }
    EXPECT_NEAR(before, 1, 1e-6);
}

TEST(LimitSurface, SmoothNormalsAreSharedAndPointOutwards) {
    const TriangleMesh mesh = tessellate(test::cubeCage(), 8).mesh;
    EXPECT_EQ(mesh.normals.size(), mesh.positions.size());
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        const Vec3f &a = mesh.positions[mesh.triangles[i][0]],
                    &b = mesh.positions[mesh.triangles[i][1]],
                    &c = mesh.positions[mesh.triangles[i][2]];
        const Vec3f facing = normalize(cross(b - a, c - a));
        EXPECT_GT(dot(facing, a), 0);
        for (std::size_t corner = 0; corner < 3; ++corner) {
            const Vec3f& normal = mesh.normals[mesh.normalIndices[i][corner]];
            EXPECT_GT(dot(normal, facing), 0.97f);
        }
    }
}

TEST(LimitSurface, TextureCoordinatesAreLinearOnEachFace) {
    SubdivisionCage cage = test::gridCage(3);
    for (const Vec3f& p : cage.mesh.positions) cage.mesh.texcoords.push_back({p.x, 2 * p.y});
    cage.mesh.texcoordIndices.assign(cage.mesh.vertexIndices.begin(),
                                     cage.mesh.vertexIndices.end());
    cage.mesh.faceMaterials = {0, 1, 2, 3, 4, 5, 6, 7, 8};
    const TriangleMesh mesh = tessellate(cage, 2).mesh;
    ASSERT_EQ(mesh.texcoordIndices.size(), 9u * 8);
    std::set<std::pair<float, float>> seen;
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        EXPECT_EQ(mesh.materials[i], mesh.faces[i]);
        for (std::size_t corner = 0; corner < 3; ++corner) {
            const Vec2f t = mesh.texcoords[mesh.texcoordIndices[i][corner]];
            seen.insert({t.x, t.y});
            const auto face = static_cast<int>(mesh.faces[i]);
            EXPECT_GE(t.x, static_cast<float>(face % 3) - 1e-6f);
            EXPECT_LE(t.x, static_cast<float>(face % 3 + 1) + 1e-6f);
            EXPECT_NEAR(std::remainder(t.x, 0.5f), 0, 1e-6f);
            EXPECT_NEAR(std::remainder(t.y, 1.0f), 0, 1e-6f);
        }
    }
    EXPECT_EQ(seen.size(), 49u);
}

// A grid whose inner vertices are moved within its plane, with (x, y) as texture coordinates.
SubdivisionCage movedGrid(bool ownTexcoordAtEachCorner) {
    SubdivisionCage cage = test::gridCage(4);
    for (std::size_t i = 0; i < cage.mesh.positions.size(); ++i) {
        Vec3f& p = cage.mesh.positions[i];
        if (p.x == 0 || p.x == 4 || p.y == 0 || p.y == 4) continue;
        p.x += 0.3f * static_cast<float>(i % 3) - 0.2f;
        p.y += 0.2f * static_cast<float>(i % 4) - 0.3f;
    }
    PolygonMesh& mesh = cage.mesh;
    for (const std::uint32_t vertex : mesh.vertexIndices) {
        const Vec3f& p = mesh.positions[vertex];
        mesh.texcoordIndices.push_back(static_cast<std::int32_t>(
            ownTexcoordAtEachCorner ? mesh.texcoords.size() : std::size_t{vertex}));
        if (ownTexcoordAtEachCorner) mesh.texcoords.push_back({p.x, p.y});
    }
    if (!ownTexcoordAtEachCorner) {
        for (const Vec3f& p : mesh.positions) mesh.texcoords.push_back({p.x, p.y});
    }
    return cage;
}

float largestWayFromTexcoords(const TriangleMesh& mesh) {
    float largest = 0;
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        for (std::size_t corner = 0; corner < 3; ++corner) {
            const Vec3f p = mesh.positions[mesh.triangles[i][corner]];
            const Vec2f t = mesh.texcoords[mesh.texcoordIndices[i][corner]];
            largest = std::max({largest, std::abs(t.x - p.x), std::abs(t.y - p.y)});
        }
    }
    return largest;
}

// What goes linearly with the cage's points goes so with the limit's: a texture isn't pulled along.
TEST(LimitSurface, TextureCoordinatesAreAsSmoothAsTheSurface) {
    for (const bool own : {false, true}) {
        SubdivisionCage cage = movedGrid(own);
        EXPECT_LT(largestWayFromTexcoords(tessellate(cage, 4).mesh), 2e-6f) << own;
        cage.faceVarying = FaceVaryingInterpolation::kAllLinear;
        EXPECT_GT(largestWayFromTexcoords(tessellate(cage, 4).mesh), 0.05f) << own;
    }
}

TEST(LimitSurface, TextureCoordinatesAreLinearAlongTheEdgesOfCharts) {
    SubdivisionCage cage = movedGrid(true);
    PolygonMesh& mesh = cage.mesh;
    constexpr float kAway = 10;
    std::vector<float> seam(5);  // u of the cage's points at x = 2 of the left chart, by their row
    for (std::size_t corner = 0; corner < mesh.vertexIndices.size(); ++corner) {
        const std::size_t vertex = mesh.vertexIndices[corner];
        if (vertex % 5 == 2) seam[vertex / 5] = mesh.positions[vertex].x;
        if (corner / 4 % 4 >= 2) mesh.texcoords[corner].x += kAway;
    }
    // Twice as fine is the same points and one in the middle of each two.
    std::set<float> left;
    const TriangleMesh fine = tessellate(cage, 2).mesh;
    for (std::size_t i = 0; i < fine.triangles.size(); ++i) {
        if (fine.faces[i] % 4 != 1) continue;  // the left chart's faces at the seam
        for (const std::uint32_t index : fine.texcoordIndices[i])
            left.insert(fine.texcoords[index].x);
    }
    for (std::size_t row = 0; row + 1 < seam.size(); ++row) {
        const float middle = 0.5f * (seam[row] + seam[row + 1]);
        const auto next = left.lower_bound(middle - 1e-6f);
        EXPECT_TRUE(next != left.end() && *next < middle + 1e-6f) << row;
        EXPECT_TRUE(left.lower_bound(seam[row] - 1e-6f) != left.end()) << row;
    }
}

}  // namespace
}  // namespace pm
