// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Groups of neighbouring places.
#include "integrator/photons/emission/place_groups.h"

#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <cstdint>
#include <set>
#include <vector>

#include "integrator/values/error.h"
#include "tests/support/statistics.h"

namespace pm::test {
namespace {

// As many places in each cell of a grid of 4 x 4 x 4, in an order of their own: the cells are the
// groups.
TEST(PlaceGroups, OfAGridAreItsCells) {
    constexpr std::size_t kCells = 64, kPlaces = 37;
    std::vector<Vec3d> places;
    std::vector<std::size_t> cellOf;
    Random random(1);
    for (std::size_t i = 0; i < kCells * kPlaces; ++i) {
        const std::size_t cell = 29 * i % kCells;
        const Vec2f a = random.next2D(), b = random.next2D();
        places.push_back(Vec3d{static_cast<double>(cell % 4), static_cast<double>(cell / 4 % 4),
                               static_cast<double>(cell / 16)} +
                         Vec3d(Vec3f{a.x, a.y, b.x}));
        cellOf.push_back(cell);
    }
    const auto groups = groupByPlace(places, kCells);
    ASSERT_EQ(groups.size(), places.size());
    std::array<std::set<std::size_t>, kCells> cellsOf;
    for (std::size_t i = 0; i < groups.size(); ++i) {
        ASSERT_LT(groups[i], kCells);
        cellsOf[groups[i]].insert(cellOf[i]);
    }
    for (const auto& cells : cellsOf) EXPECT_EQ(cells.size(), 1u);
}

// Of equal places those that come first are together; of few some groups have none.
TEST(PlaceGroups, OfEqualAndOfFewPlaces) {
    const auto equal = groupByPlace(std::vector<Vec3d>(256, Vec3d(0.25)), 64);
    for (std::size_t i = 0; i < equal.size(); ++i) EXPECT_EQ(equal[i], i / 4) << i;
    const std::vector<Vec3d> few = {{1, 0, 0}, {-1, 0, 0}, {0, 0, 0}};
    const auto groups = groupByPlace(few, 256);
    EXPECT_EQ(std::set(groups.begin(), groups.end()).size(), 3u);
    EXPECT_TRUE(groupByPlace({}, 64).empty());
}

TEST(PlaceGroups, CanBeCancelled) {
    const std::vector<Vec3d> places = {{1, 0, 0}, {-1, 0, 0}};
    const std::atomic<bool> cancelled{true};
    try {
        groupByPlace(places, 64, CancelCheck(cancelled));
        FAIL() << "not cancelled";
    } catch (const Error& error) {
        EXPECT_EQ(error.status(), Status::kCancelled);
    }
}

}  // namespace
}  // namespace pm::test
