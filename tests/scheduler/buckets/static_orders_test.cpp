// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "scheduler/buckets/static_orders.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <utility>

#include "integrator/values/error.h"
#include "scheduler/buckets/bucket_order.h"

namespace pm {
namespace {

using Cells = std::vector<std::uint32_t>;

bool isPermutation(const Cells& order, std::int32_t columns, std::int32_t rows) {
    const std::size_t cells = static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows);
    if (order.size() != cells) return false;
    std::vector<bool> seen(cells);
    for (const std::uint32_t cell : order) {
        if (cell >= cells || seen[cell]) return false;
        seen[cell] = true;
    }
    return true;
}

// What makes each order that order, cell after cell: whether b may follow a on a grid w x h.
struct Place {
    std::int64_t x, y;
};
using MayFollow = bool (*)(Place a, Place b, std::int64_t w, std::int64_t h);

bool follows(const Cells& order, std::int32_t columns, std::int32_t rows, MayFollow mayFollow) {
    const std::int64_t w = columns, h = rows;
    for (std::size_t i = 1; i < order.size(); ++i) {
        const Place a{order[i - 1] % w, order[i - 1] / w}, b{order[i] % w, order[i] / w};
        if (!mayFollow(a, b, w, h)) return false;
    }
    return true;
}

bool byRows(Place a, Place b, std::int64_t w, std::int64_t) {
    return b.y == a.y ? b.x == a.x + 1 : a.x == w - 1 && b.x == 0 && b.y == a.y + 1;
}

bool byColumns(Place a, Place b, std::int64_t, std::int64_t h) {
    return b.x == a.x ? b.y == a.y + 1 : a.y == h - 1 && b.y == 0 && b.x == a.x + 1;
}

bool byDiagonals(Place a, Place b, std::int64_t w, std::int64_t h) {
    if (b.x + b.y == a.x + a.y) return b.y == a.y + 1;
    const bool endsOne = a.x == 0 || a.y == h - 1, beginsOne = b.y == 0 || b.x == w - 1;
    return b.x + b.y == a.x + a.y + 1 && endsOne && beginsOne;
}

// How many squares around the centre a cell lies out. Of an even side the centre is the cell before
// the middle along the long side and the one after it along the short one.
std::int64_t ringOf(Place p, std::int64_t w, std::int64_t h) {
    if (h > w) {
        std::swap(p.x, p.y);
        std::swap(w, h);
    }
    return std::max(std::abs(p.x - (w - 1) / 2), std::abs(p.y - h / 2));
}

// Never inwards; within a ring that is whole always to the cell beside.
bool spirals(Place a, Place b, std::int64_t w, std::int64_t h) {
    const std::int64_t outwards = ringOf(b, w, h) - ringOf(a, w, h);
    const bool isWhole = 2 * ringOf(b, w, h) <= std::min(w, h);
    const bool isBeside = std::abs(a.x - b.x) + std::abs(a.y - b.y) == 1;
    return (outwards == 0 || outwards == 1) && (isBeside || !isWhole);
}

std::int64_t jumpsIn(const Cells& order, std::int64_t w) {
    std::int64_t jumps = 0;
    for (std::size_t i = 1; i < order.size(); ++i) {
        const Place a{order[i - 1] % w, order[i - 1] / w}, b{order[i] % w, order[i] / w};
        jumps += std::abs(a.x - b.x) + std::abs(a.y - b.y) == 1 ? 0 : 1;
    }
    return jumps;
}

struct Walk {
    const char* name;
    Cells (*cells)(std::int32_t, std::int32_t);
    MayFollow mayFollow;
    bool startsTopLeft;
};
constexpr Walk kWalks[] = {{"row", rowOrder, byRows, true},
                           {"column", columnOrder, byColumns, true},
                           {"diagonal", diagonalOrder, byDiagonals, true},
                           {"spiral", spiralOrder, spirals, false}};

void expectWalk(const Walk& walk, std::int32_t columns, std::int32_t rows) {
    const Cells order = walk.cells(columns, rows);
    ASSERT_TRUE(isPermutation(order, columns, rows))
        << walk.name << ' ' << columns << " x " << rows;
    ASSERT_TRUE(follows(order, columns, rows, walk.mayFollow))
        << walk.name << ' ' << columns << " x " << rows;
    if (order.empty()) return;
    const std::int64_t w = columns, h = rows;
    if (walk.startsTopLeft) {
        ASSERT_EQ(order.front(), 0u) << walk.name;
    } else {
        const Place first{order.front() % w, order.front() / w};
        ASSERT_EQ(ringOf(first, w, h), 0) << columns << " x " << rows;
        // A jump for each column or row beyond the short side, but for the first.
        ASSERT_EQ(jumpsIn(order, w), std::max<std::int64_t>(std::abs(w - h) - 1, 0))
            << columns << " x " << rows;
    }
}

TEST(StaticOrders, areWhatTheyAreCalledForEveryGridUpTo64) {
    for (const Walk& walk : kWalks) {
        for (std::int32_t rows = 0; rows <= 64; ++rows) {
            for (std::int32_t columns = 0; columns <= 64; ++columns) {
                ASSERT_NO_FATAL_FAILURE(expectWalk(walk, columns, rows));
            }
        }
    }
}

constexpr std::pair<std::int32_t, std::int32_t> kHuge[] = {
    {1, 100000}, {100000, 1}, {2, 100000}, {100001, 3}, {1500, 1000}, {999, 1501}, {1024, 1025}};

TEST(StaticOrders, areWhatTheyAreCalledForHugeAndSkinnyGrids) {
    for (const Walk& walk : kWalks) {
        for (const auto& [columns, rows] : kHuge) {
            ASSERT_NO_FATAL_FAILURE(expectWalk(walk, columns, rows));
        }
    }
}

TEST(StaticOrders, spiralOfASmallFrame) {
    EXPECT_EQ(spiralOrder(3, 3), (Cells{4, 5, 2, 1, 0, 3, 6, 7, 8}));
    EXPECT_EQ(spiralOrder(4, 3), (Cells{5, 6, 2, 1, 0, 4, 8, 9, 10, 11, 7, 3}));
    EXPECT_EQ(spiralOrder(5, 1), (Cells{2, 3, 1, 4, 0}));
}

// The checks see what they are for.
TEST(StaticOrders, checksSeeOtherOrders) {
    for (const Walk& walk : kWalks) {
        for (const Walk& other : kWalks) {
            EXPECT_EQ(follows(other.cells(5, 4), 5, 4, walk.mayFollow), &walk == &other)
                << other.name << " taken for " << walk.name;
        }
    }
    Cells twice = spiralOrder(5, 4);
    twice[7] = twice[9];
    EXPECT_FALSE(isPermutation(twice, 5, 4));
    Cells inwards = spiralOrder(5, 4);
    std::reverse(inwards.begin(), inwards.end());
    EXPECT_FALSE(follows(inwards, 5, 4, spirals));
}

TEST(RandomOrder, isAPermutationForEveryGridUpTo64AndHugeOnes) {
    for (std::int32_t rows = 0; rows <= 64; ++rows) {
        for (std::int32_t columns = 0; columns <= 64; ++columns) {
            ASSERT_TRUE(isPermutation(randomOrder(columns, rows, 1), columns, rows))
                << columns << " x " << rows;
        }
    }
    for (const auto& [columns, rows] : kHuge) {
        EXPECT_TRUE(isPermutation(randomOrder(columns, rows, 1), columns, rows));
    }
}

// SplitMix64's published first numbers for the seed 1234567 are 6457827717110365317,
// 3203168211198807973, 9817491932198370423; modulo 4, 3 and 2 they are 1, 1 and 1.
TEST(RandomOrder, isTheSameOnEveryMachine) {
    EXPECT_EQ(randomOrder(2, 2, 1234567), (Cells{0, 2, 3, 1}));
    EXPECT_EQ(randomOrder(40, 30, 7), randomOrder(40, 30, 7));
    EXPECT_NE(randomOrder(40, 30, 7), randomOrder(40, 30, 8));
    EXPECT_NE(randomOrder(40, 30, 7), rowOrder(40, 30));
}

// Over fixed seeds, all 24 orders of four cells are equally likely: chi squared with 23 degrees of
// freedom, whose 1 - 1e-6 quantile is 70.5.
TEST(RandomOrder, everyOrderIsAsLikely) {
    constexpr int kSeeds = 24000;
    std::map<Cells, int> counts;
    for (std::uint64_t seed = 0; seed < kSeeds; ++seed) ++counts[randomOrder(4, 1, seed)];
    EXPECT_EQ(counts.size(), 24u);
    double chiSquared = 0;
    for (const auto& [order, count] : counts) {
        const double expected = kSeeds / 24.0;
        chiSquared += (count - expected) * (count - expected) / expected;
    }
    EXPECT_LT(chiSquared, 70.5);
    fmt::print("chi squared over 24 orders: {:.1f}\n", chiSquared);
}

TEST(AllOrders, arePermutationsAndRefuseBadCounts) {
    for (const BucketOrder& order : bucketOrders()) {
        for (const auto& [columns, rows] : {std::pair{0, 0}, {0, 5}, {5, 0}, {7, 5}, {64, 48}}) {
            EXPECT_TRUE(isPermutation(order.cells(columns, rows, 3), columns, rows)) << order.name;
        }
        EXPECT_THROW(order.cells(-1, 4, 1), Error);
        EXPECT_THROW(order.cells(4, -1, 1), Error);
        EXPECT_THROW(order.cells(-4, -4, 1), Error);
        EXPECT_THROW(order.cells(70000, 70000, 1), Error);
    }
}

}  // namespace
}  // namespace pm
