// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Groups of a limit surface: what triangles they hold, and that neighbours fit.
#include "integrator/tessellation/limit_groups.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <map>
#include <tuple>
#include <vector>

#include "integrator/geometry/subdivision.h"
#include "tests/integrator/geometry/obj_cage.h"
#include "tests/support/limit_scene.h"

namespace pm::test {
namespace {

LimitGroups groupsOf(SubdivisionCage cage, const TessellationRule& rule,
                     std::vector<const HeightField*> heights = {},
                     const Transform& place = kIdentityTransform) {
    return {std::make_shared<const LimitShape>(std::move(cage), 4),
            place,
            std::move(heights),
            rule,
            {}};
}

// Each face with a chart of its own, so that every edge is a seam.
SubdivisionCage withSeams(SubdivisionCage cage) {
    PolygonMesh& mesh = cage.mesh;
    mesh.texcoords.clear();
    mesh.texcoordIndices.clear();
    std::size_t face = 0;
    for (const std::uint32_t size : mesh.faceVertexCounts) {
        for (std::uint32_t i = 0; i < size; ++i) {
            const double angle = 6.283185307179586 * i / size + 0.7 * static_cast<double>(face);
            mesh.texcoordIndices.push_back(static_cast<std::int32_t>(mesh.texcoords.size()));
            mesh.texcoords.push_back({static_cast<float>(0.5 + 0.4 * std::cos(angle)),
                                      static_cast<float>(0.5 + 0.4 * std::sin(angle))});
        }
        ++face;
    }
    return cage;
}

TessellationRule closeBy(const Vec3d& eye) {
    TessellationRule rule;
    rule.viewpoint = {eye, normalize(-eye), 0.4, 0.04};
    return rule;
}

using Place = std::tuple<std::uint32_t, std::uint32_t, std::uint32_t>;
Place placeOf(const Vec3f& p) {
    return {std::bit_cast<std::uint32_t>(p.x + 0.0f), std::bit_cast<std::uint32_t>(p.y + 0.0f),
            std::bit_cast<std::uint32_t>(p.z + 0.0f)};
}

// Edges that triangles on one side only have, by the bits of their ends; 0: there is no gap.
std::size_t openEdges(const std::vector<const LimitGroups*>& all) {
    std::map<std::pair<Place, Place>, int> edges;
    for (const LimitGroups* const groups : all)
        for (std::uint32_t g = 0; g < groups->groupCount(); ++g) {
            const auto group = groups->make(g);
            EXPECT_EQ(group->triangleCount(), groups->trianglesOf(g));
            for (std::uint32_t t = 0; t < group->triangleCount(); ++t)
                for (std::size_t k = 0; k < 3; ++k) {
                    const Place a = placeOf(group->point(t, k).position),
                                b = placeOf(group->point(t, (k + 1) % 3).position);
                    if (a < b) ++edges[{a, b}];
                    if (b < a) --edges[{b, a}];
                }
        }
    return static_cast<std::size_t>(
        std::ranges::count_if(edges, [](const auto& edge) { return edge.second != 0; }));
}

std::size_t openEdges(const LimitGroups& groups) {
    return openEdges(std::vector{&groups});
}

bool isInBox(const LimitGroups& groups, std::uint32_t g) {
    const auto group = groups.make(g);
    const Box3d& box = groups.box(g);
    for (std::uint32_t t = 0; t < group->triangleCount(); ++t)
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec3d p(group->point(t, k).position);
            for (int axis = 0; axis < 3; ++axis)
                if (!(p[axis] >= box.lo[axis] && p[axis] <= box.hi[axis])) return false;
        }
    return true;
}

TEST(LimitGroups, HaveThePointsOfThePlainMesh) {
    TessellationRule rule;
    rule.rate = 8;
    const LimitGroups groups = groupsOf(cubeCage(), rule);
    const TriangleMesh plain = tessellate(cubeCage(), 8).mesh;
    EXPECT_EQ(groups.triangleCount(), plain.triangles.size());
    std::map<Place, int> places;
    for (const Vec3f& p : plain.positions) places[placeOf(p)] = 1;
    for (const Vec3f& p : gathered(groups).positions) {
        ASSERT_EQ(places.count(placeOf(p)), 1u);
        places[placeOf(p)] = 2;
    }
    for (const auto& [place, seen] : places) EXPECT_EQ(seen, 2);
}

TEST(LimitGroups, FitAtEdgesOfUnlikeRates) {
    const LimitGroups groups = groupsOf(cubeCage(), closeBy({0.3, 0.5, 1.6}));
    const LimitGroups alike = groupsOf(cubeCage(), TessellationRule{8, {}});
    EXPECT_NE(groups.triangleCount(), alike.triangleCount());
    EXPECT_EQ(openEdges(groups), 0u);
    EXPECT_EQ(openEdges(alike), 0u);
}

TEST(LimitGroups, FitWhereTheyAreDisplacedAcrossSeams) {
    const Waves waves(0.1);
    const LimitGroups groups = groupsOf(withSeams(cubeCage()), closeBy({0.3, 0.5, 1.6}), {&waves});
    EXPECT_EQ(openEdges(groups), 0u);
    for (std::uint32_t g = 0; g < groups.groupCount(); ++g) EXPECT_TRUE(isInBox(groups, g)) << g;
}

// Two that each leave out what the other has are where one with all would be.
TEST(LimitGroups, FitThoseThatTheyLeftOut) {
    const Waves waves(0.1);
    SubdivisionCage cage = withSeams(cubeCage());
    for (std::uint32_t face = 0; face < 6; ++face) cage.mesh.faceMaterials.push_back(face % 2);
    const auto shape = std::make_shared<const LimitShape>(cage, 4);
    const TessellationRule rule = closeBy({0.3, 0.5, 1.6});
    const auto without = [&](std::vector<bool> slots) {
        return LimitGroups(shape, kIdentityTransform, {&waves, nullptr}, rule, {},
                           std::move(slots));
    };
    const LimitGroups all = without({}), first = without({false, true}),
                      second = without({true, false});
    EXPECT_EQ(first.triangleCount() + second.triangleCount(), all.triangleCount());
    EXPECT_EQ(first.slot(0), 0u);
    EXPECT_EQ(second.slot(0), 1u);
    EXPECT_GT(openEdges(first), 0u);
    EXPECT_EQ(openEdges({&first, &second}), 0u);
    std::size_t ofCage = 0;
    for (std::uint32_t slot = 0; slot < 2; ++slot)
        first.forEachCageTriangle(slot, [&](const auto&) { ++ofCage; });
    EXPECT_EQ(ofCage, 6u);
}

TEST(LimitGroups, OfLargeFacesAreParts) {
    SubdivisionCage cage = cubeCage();
    cage.scheme = SubdivisionScheme::kBilinear;
    // Each edge at a rate of its own.
    TessellationRule rule;
    rule.viewpoint = {{1.2, 1.4, 1.7}, normalize(Vec3d{-1, -1, -1}), 0.7, 0.011};
    const LimitGroups groups = groupsOf(withSeams(cage), rule);
    EXPECT_GT(groups.groupCount(), 20u);
    EXPECT_GT(groups.triangleCount(), 20'000u);
    std::uint32_t most = 0;
    for (std::uint32_t g = 0; g < groups.groupCount(); ++g) {
        most = std::max(most, groups.trianglesOf(g));
        EXPECT_TRUE(isInBox(groups, g)) << g;
    }
    EXPECT_LE(most, 2048u);
    EXPECT_EQ(openEdges(groups), 0u);
}

// The cube's six unit faces, cut into triangles of any size, have its area; strips and blocks lie
// beside each other and not upon each other.
TEST(LimitGroups, OfLargeFacesCoverThemOnce) {
    SubdivisionCage cage = cubeCage();
    cage.scheme = SubdivisionScheme::kBilinear;
    TessellationRule rule;
    rule.viewpoint = {{1.2, 1.4, 1.7}, normalize(Vec3d{-1, -1, -1}), 0.7, 0.011};
    const TriangleMesh mesh = gathered(groupsOf(cage, rule));
    double area = 0;
    for (const auto& t : mesh.triangles) {
        const Vec3d a(mesh.positions[t[0]]);
        const Vec3d n = cross(Vec3d(mesh.positions[t[1]]) - a, Vec3d(mesh.positions[t[2]]) - a);
        area += 0.5 * length(n);
        EXPECT_GT(dot(n, a), 0.0);  // outwards
    }
    EXPECT_NEAR(area, 24.0, 1e-4);
}

TEST(LimitGroups, NamesTrianglesByGroup) {
    const LimitGroups groups = groupsOf(gridCage(40), TessellationRule{6, {}});
    ASSERT_GT(groups.groupCount(), 10u);
    for (std::uint32_t g = 0; g < groups.groupCount(); ++g) {
        EXPECT_EQ(groups.groupOf(groups.firstTriangle(g)), g);
        EXPECT_EQ(groups.groupOf(groups.firstTriangle(g) + groups.trianglesOf(g) - 1), g);
    }
}

// Near ones, so that a group's box is small.
TEST(LimitGroups, AreOfNeighbours) {
    const LimitGroups groups = groupsOf(gridCage(64), TessellationRule{4, {}});
    double area = 0;
    for (std::uint32_t g = 0; g < groups.groupCount(); ++g) {
        const Vec3d size = groups.box(g).size();
        area += size.x * size.y;
    }
    EXPECT_LT(area, 3.0 * 64 * 64);
}

// Boxes are as wide as the displacement may be; once made, a group is asked for by those rays alone
// that meet its own box, though it is no longer held.
TEST(LimitGroups, AreNotMadeAgainForRaysThatPassBy) {
    const Waves waves(3.0, 0.0);  // of one height everywhere
    SubdivisionCage cage = withSeams(gridCage(2));
    LimitGroups groups = groupsOf(cage, {}, {&waves});
    GroupCache cache(groups.groupCount(), 0);
    groups.keepIn(cache, 0);
    const Box3d& box = groups.box(0);
    const double top = groups.pin(0)->hi().z;
    ASSERT_LT(top, box.hi.z - 1.0);
    const Vec3d middle = 0.5 * (box.lo + box.hi);
    const ShearedRay down(Vec3f(Vec3d{middle.x, middle.y, box.hi.z}), {0, 0, -1});
    const ShearedRay by(Vec3f(Vec3d{box.lo.x - 1.0, middle.y, top + 0.5}), {1, 0, 0});
    EXPECT_TRUE(static_cast<bool>(groups.pinFor(0, down, 0.0, 100.0)));
    EXPECT_FALSE(static_cast<bool>(groups.pinFor(0, down, 0.0, 0.5))) << "ends before";
    EXPECT_FALSE(static_cast<bool>(groups.pinFor(0, by, 0.0, 100.0)));
    LimitGroups other = groupsOf(cage, {}, {&waves});
    other.keepIn(cache, 0);
    EXPECT_TRUE(static_cast<bool>(other.pinFor(0, by, 0.0, 100.0))) << "nothing is known yet";
}

// Every shape of OpenSubdiv's, under each rule: all that lies in boxes, and closed where its cage
// is.
TEST(LimitGroups, OfEveryRegressionShape) {
    const auto files = objFiles(PM_SHARED_DATA "/subdiv");
    if (files.empty()) GTEST_SKIP() << "no ../shared/data/subdiv";
    const Waves waves(0.05);
    for (const auto& file : files) {
        SCOPED_TRACE(file.filename().string());
        const SubdivisionCage cage = readObjCage(file);
        const LimitGroups plain = groupsOf(cage, TessellationRule{5, {}});
        const LimitGroups displaced = groupsOf(withSeams(cage), closeBy({1, 2, 3}), {&waves});
        for (std::uint32_t g = 0; g < plain.groupCount(); ++g) EXPECT_TRUE(isInBox(plain, g));
        for (std::uint32_t g = 0; g < displaced.groupCount(); ++g)
            EXPECT_TRUE(isInBox(displaced, g));
        const std::size_t open = openEdges(groupsOf(cage, TessellationRule{1, {}}));
        if (open == 0) {
            EXPECT_EQ(openEdges(plain), 0u);
            EXPECT_EQ(openEdges(displaced), 0u);
        }
    }
}

}  // namespace
}  // namespace pm::test
