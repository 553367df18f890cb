// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/geometry/triangulate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <numbers>
#include <random>
#include <vector>

#include "integrator/geometry/polygon_clipper.h"
#include "tests/integrator/geometry/obj_cage.h"

namespace pm {
namespace {

using Polygon = std::vector<Vec3d>;

Vec3d areaVector(const Polygon& p, const TriangleMesh::Corners& t) {
    return cross(p[t[1]] - p[t[0]], p[t[2]] - p[t[0]]) * 0.5;
}

// Cuts a polygon and checks what holds for every one that does not cross itself: n - 2 triangles,
// none turned over, whose areas add up to the shoelace area (signed sums always would; these are
// sums of sizes).
void expectExactCover(const Polygon& polygon) {
    std::vector<TriangleMesh::Corners> triangles;
    EXPECT_TRUE(PolygonClipper().clip(polygon, triangles));
    ASSERT_EQ(triangles.size(), polygon.size() - 2);
    const Vec3d newell = newellNormal(polygon);
    const double area = length(newell) * 0.5;
    double covered = 0;
    for (const TriangleMesh::Corners& triangle : triangles) {
        for (const std::uint32_t corner : triangle) ASSERT_LT(corner, polygon.size());
        const Vec3d vector = areaVector(polygon, triangle);
        EXPECT_GE(dot(vector, newell) / length(newell), -1e-9 * area);
        covered += length(vector);
    }
    EXPECT_NEAR(covered, area, 1e-9 * area);
}

Polygon inPlane(const std::vector<Vec2f>& points, const Vec3d& u, const Vec3d& v) {
    Polygon polygon;
    for (const Vec2f& p : points) {
        polygon.push_back(Vec3d(5, -3, 2) + u * double{p.x} + v * double{p.y});
    }
    return polygon;
}

// A polygon around the origin with radii at random: concave, but never crossing itself.
std::vector<Vec2f> randomStar(std::mt19937& random, int corners) {
    std::uniform_real_distribution<double> radius(0.05, 1.0), shift(0.0, 0.9);
    std::vector<Vec2f> points;
    for (int i = 0; i < corners; ++i) {
        const double angle = 2 * std::numbers::pi * (i + shift(random)) / corners;
        const double r = radius(random);
        points.push_back(
            {static_cast<float>(r * std::cos(angle)), static_cast<float>(r * std::sin(angle))});
    }
    return points;
}

TEST(PolygonClipper, RandomStarsInRandomPlanes) {
    std::mt19937 random(1);
    std::normal_distribution<double> gauss;
    for (int i = 0; i < 2000; ++i) {
        const Vec3d u = normalize(Vec3d(gauss(random), gauss(random), gauss(random)));
        const Vec3d v = normalize(cross(u, Vec3d(gauss(random), gauss(random), gauss(random))));
        expectExactCover(inPlane(randomStar(random, 5 + i % 60), u, v));
        if (HasFailure()) FAIL() << "polygon " << i;
    }
}

// Two arms wound around each other: every ear but those at the ends is blocked.
TEST(PolygonClipper, SpiralsAndCombs) {
    std::vector<Vec2f> spiral, comb;
    constexpr int kSteps = 200;
    const auto at = [](double angle, double offset) {
        const double r = 0.1 * angle + offset;
        return Vec2f{static_cast<float>(r * std::cos(angle)),
                     static_cast<float>(r * std::sin(angle))};
    };
    for (int i = 0; i <= kSteps; ++i) spiral.push_back(at(0.2 * i, 1.3));
    for (int i = kSteps; i >= 0; --i) spiral.push_back(at(0.2 * i, 1.0));
    // Outer arm forwards, inner arm back: counterclockwise.
    expectExactCover(inPlane(spiral, {1, 0, 0}, {0, 1, 0}));
    expectExactCover(inPlane(spiral, {0, 0.6, 0.8}, {1, 0, 0}));

    for (int i = 0; i < 50; ++i) {
        const auto x = static_cast<float>(2 * i);
        comb.insert(comb.end(), {{x, 0}, {x + 0.1f, -5}, {x + 1, -5}, {x + 1.1f, 0}});
    }
    comb.insert(comb.end(), {{100, 1}, {-1, 1}});
    expectExactCover(inPlane(comb, {1, 0, 0}, {0, 1, 0}));
}

// Points on straight edges must neither be lost nor turn anything over.
TEST(PolygonClipper, PointsInLine) {
    std::vector<Vec2f> points;
    for (int i = 0; i < 10; ++i) points.push_back({static_cast<float>(i), 0});
    for (int i = 0; i < 10; ++i) points.push_back({10, static_cast<float>(i)});
    points.push_back({10, 10});
    points.push_back({0, 10});
    expectExactCover(inPlane(points, {1, 0, 0}, {0, 1, 0}));
    expectExactCover(inPlane(points, {0.6, 0.8, 0}, {0, 0, 1}));
    // A triangle with all its extra points on one side, as collapsing a border leaves it.
    expectExactCover({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {4, 0, 0}, {0, 5, 0}});
}

// A square with a square hole, joined by a slit that is run along twice.
TEST(PolygonClipper, SlitToAHole) {
    expectExactCover({{0, 0, 0},
                      {9, 0, 0},
                      {9, 9, 0},
                      {0, 9, 0},
                      {0, 0, 0},
                      {3, 3, 0},
                      {3, 6, 0},
                      {6, 6, 0},
                      {6, 3, 0},
                      {3, 3, 0}});
}

TEST(PolygonClipper, QuadsUseTheDiagonalThatFits) {
    // Darts: the reflex corner at each of the four places.
    const Polygon dart = {{0, 0, 0}, {4, -1, 0}, {1, 0, 0}, {4, 1, 0}};
    for (std::size_t turn = 0; turn < 4; ++turn) {
        Polygon turned;
        for (std::size_t i = 0; i < 4; ++i) turned.push_back(dart[(i + turn) % 4]);
        expectExactCover(turned);
    }
    // Of a convex quad's diagonals, the shorter.
    std::vector<TriangleMesh::Corners> triangles;
    EXPECT_TRUE(
        PolygonClipper().clip(Polygon{{0, 0, 0}, {5, -1, 0}, {10, 0, 0}, {5, 1, 0}}, triangles));
    EXPECT_EQ(triangles[0], (TriangleMesh::Corners{0, 1, 3}));
    // Three corners in line: the other diagonal would make a triangle without area.
    expectExactCover({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {1, 1, 0}});
}

TEST(PolygonClipper, BentPolygonsKeepTheirSide) {
    std::mt19937 random(2);
    std::uniform_real_distribution<double> bend(-0.01, 0.01);
    for (int i = 0; i < 300; ++i) {
        Polygon polygon = inPlane(randomStar(random, 4 + i % 20), {1, 0, 0}, {0, 1, 0});
        for (Vec3d& p : polygon) p.z += bend(random);
        std::vector<TriangleMesh::Corners> triangles;
        EXPECT_TRUE(PolygonClipper().clip(polygon, triangles));
        double covered = 0, flatArea = 0;
        for (const TriangleMesh::Corners& t : triangles)
            covered += std::abs(areaVector(polygon, t).z);
        for (const TriangleMesh::Corners& t : triangles) flatArea += areaVector(polygon, t).z;
        EXPECT_NEAR(covered, flatArea, 0.01 * flatArea) << i;
    }
}

TEST(PolygonClipper, CrossingPolygonsAreFannedAndCounted) {
    std::vector<TriangleMesh::Corners> triangles;
    EXPECT_FALSE(
        PolygonClipper().clip(Polygon{{0, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, 1, 0}}, triangles));
    EXPECT_EQ(triangles.size(), 2u);
    triangles.clear();
    const Polygon pentagram = {{0, 3, 0}, {2, -3, 0}, {-3, 1, 0}, {3, 1, 0}, {-2, -3, 0}};
    PolygonClipper().clip(pentagram, triangles);
    EXPECT_EQ(triangles.size(), 3u);
    triangles.clear();
    EXPECT_FALSE(PolygonClipper().clip(Polygon(7, Vec3d(1, 2, 3)), triangles));
    EXPECT_EQ(triangles.size(), 5u);
}

TEST(PolygonClipper, LargePolygonsAreQuick) {
    Polygon circle;
    for (int i = 0; i < 65535; ++i) {
        const double angle = 2 * std::numbers::pi * i / 65535;
        circle.emplace_back(std::cos(angle), std::sin(angle), 0.0);
    }
    expectExactCover(circle);
}

// Real files with concave faces, where a well-known loader's own triangulation loses some.
TEST(Triangulate, OddFilesLoseNoTriangle) {
    const auto files = test::objFiles(PM_SHARED_DATA "/obj-odd/tinyobjloader-models");
    if (files.empty()) GTEST_SKIP() << "no shared data";
    std::size_t polygons = 0;
    for (const std::filesystem::path& file : files) {
        if (file.filename().string().starts_with("invalid")) continue;
        PolygonMesh mesh = test::readObjCage(file).mesh;
        mesh.texcoordIndices.clear();
        std::size_t expected = 0;
        for (const std::uint32_t size : mesh.faceVertexCounts) expected += size - 2;
        BuiltMesh built;
        try {
            built = triangulate(mesh);
        } catch (const std::exception& error) {
            continue;  // broken on purpose
        }
        EXPECT_EQ(built.mesh.triangles.size() + built.repairs.droppedTriangles, expected) << file;
        EXPECT_EQ(built.repairs.fannedFaces, 0u) << file;
        polygons += mesh.faceCount();
    }
    EXPECT_GT(polygons, 1000u);
}

}  // namespace
}  // namespace pm
