// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "scheduler/buckets/bucket_order.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <string>
#include <utility>

#include "scheduler/buckets/hilbert_order.h"
#include "scheduler/buckets/static_orders.h"

namespace pm {
namespace {

using Cells = std::vector<std::uint32_t>;

struct Steps {
    bool permutation = true;
    std::size_t diagonal = 0;  // to a cell that shares a corner only
    std::size_t jumps = 0;     // anywhere else
};

Steps countSteps(const Cells& order, std::int32_t columns, std::int32_t rows) {
    Steps steps;
    const std::size_t cells = static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows);
    std::vector<bool> seen(cells);
    steps.permutation = order.size() == cells;
    for (std::size_t i = 0; i < order.size(); ++i) {
        if (order[i] >= cells || seen[order[i]]) {
            steps.permutation = false;
            break;
        }
        seen[order[i]] = true;
        if (i == 0) continue;
        const auto w = static_cast<std::int64_t>(columns);
        const std::int64_t a = order[i - 1], b = order[i];
        const std::int64_t dx = std::abs(a % w - b % w), dy = std::abs(a / w - b / w);
        if (dx == 1 && dy == 1) ++steps.diagonal;
        if (dx > 1 || dy > 1) ++steps.jumps;
    }
    return steps;
}

// One continuous curve: each cell once, edge steps only. The bound that the issue allows is one
// diagonal step where parity forbids better; as the end is free, parity forbids it nowhere.
bool isOneCurve(const Cells& order, std::int32_t columns, std::int32_t rows) {
    const Steps steps = countSteps(order, columns, rows);
    return steps.permutation && steps.diagonal == 0 && steps.jumps == 0 &&
           (order.empty() || order.front() == 0);
}

// The classic curve by its bits (index to cell), for a square of side 2^n; starts top left, ends
// top right.
Cells classicHilbert(std::int32_t side) {
    Cells order;
    for (std::int32_t index = 0; index < side * side; ++index) {
        std::int32_t x = 0, y = 0, rest = index;
        for (std::int32_t s = 1; s < side; s *= 2, rest /= 4) {
            const std::int32_t right = 1 & (rest / 2), down = 1 & (rest ^ right);
            if (down == 0) {
                if (right == 1) x = s - 1 - x, y = s - 1 - y;
                std::swap(x, y);
            }
            x += s * right;
            y += s * down;
        }
        order.push_back(static_cast<std::uint32_t>(y * side + x));
    }
    return order;
}

// Mean over all runs of 64 cells of the longer side of the run's bounding box.
double meanReach(const Cells& order, std::int32_t columns) {
    constexpr std::size_t kRun = 64;
    double sum = 0.0;
    std::size_t runs = 0;
    const auto w = static_cast<std::uint32_t>(columns);
    for (std::size_t begin = 0; begin + kRun <= order.size(); begin += 7, ++runs) {
        std::uint32_t x0 = ~0u, y0 = ~0u, x1 = 0, y1 = 0;
        for (std::size_t i = begin; i < begin + kRun; ++i) {
            x0 = std::min(x0, order[i] % w), x1 = std::max(x1, order[i] % w);
            y0 = std::min(y0, order[i] / w), y1 = std::max(y1, order[i] / w);
        }
        sum += std::max(x1 - x0, y1 - y0) + 1;
    }
    return sum / static_cast<double>(runs);
}

TEST(HilbertOrder, isOneCurveForEveryGridUpTo64) {
    for (std::int32_t rows = 1; rows <= 64; ++rows) {
        for (std::int32_t columns = 1; columns <= 64; ++columns) {
            ASSERT_TRUE(isOneCurve(hilbertOrder(columns, rows), columns, rows))
                << columns << " x " << rows;
        }
    }
}

TEST(HilbertOrder, isOneCurveForHugeAndSkinnyGrids) {
    const std::pair<int, int> grids[] = {{1, 100000},  {100000, 1},  {2, 100000},  {100000, 3},
                                         {100001, 4},  {4, 100001},  {3000, 2000}, {2999, 2000},
                                         {2000, 2999}, {2999, 2001}, {1025, 1024}, {4097, 2}};
    for (const auto& [columns, rows] : grids) {
        const auto begin = std::chrono::steady_clock::now();
        const Cells order = hilbertOrder(columns, rows);
        const std::chrono::duration<double, std::nano> time =
            std::chrono::steady_clock::now() - begin;
        EXPECT_TRUE(isOneCurve(order, columns, rows)) << columns << " x " << rows;
        fmt::print("hilbert {} x {}: {:.1f} ms, {:.1f} ns a cell\n", columns, rows,
                   time.count() * 1e-6, time.count() / static_cast<double>(order.size()));
    }
}

TEST(HilbertOrder, isTheClassicCurveOnPowersOfTwo) {
    for (std::int32_t side = 1; side <= 128; side *= 2) {
        Cells transposed = classicHilbert(side);
        for (std::uint32_t& cell : transposed) {
            cell = cell % static_cast<std::uint32_t>(side) * static_cast<std::uint32_t>(side) +
                   cell / static_cast<std::uint32_t>(side);
        }
        const Cells order = hilbertOrder(side, side);
        EXPECT_TRUE(order == classicHilbert(side) || order == transposed) << side;
    }
}

// What makes it Hilbert's and not any path: 64 buckets in a row stay within about 2 x 8 cells.
TEST(HilbertOrder, runsStayTogether) {
    double worst = 0.0;
    for (std::int32_t rows = 16; rows <= 96; ++rows) {
        for (std::int32_t columns = 16; columns <= 96; ++columns) {
            const double reach = meanReach(hilbertOrder(columns, rows), columns);
            ASSERT_LT(reach, 14.0) << columns << " x " << rows;
            worst = std::max(worst, reach);
        }
    }
    fmt::print("64 cells in a row reach over {:.2f} (64 x 64) and at worst {:.2f} cells\n",
               meanReach(hilbertOrder(64, 64), 64), worst);
    EXPECT_GT(meanReach(rowOrder(96, 64), 96), 60.0);
}

// The checks above see what they are for: two ways in which others got it wrong.
TEST(HilbertOrder, checksSeeBrokenCurves) {
    Cells clipped;  // the power of two around the grid, cells outside left out
    for (const std::uint32_t cell : classicHilbert(16)) {
        if (cell % 16 < 11 && cell / 16 < 9) clipped.push_back(cell / 16 * 11 + cell % 16);
    }
    EXPECT_TRUE(countSteps(clipped, 11, 9).permutation);
    EXPECT_FALSE(isOneCurve(clipped, 11, 9));
    EXPECT_FALSE(isOneCurve(rowOrder(4, 3), 4, 3));

    Cells twice = hilbertOrder(5, 4);
    twice[7] = twice[9];
    EXPECT_FALSE(countSteps(twice, 5, 4).permutation);
    Cells diagonal = hilbertOrder(2, 2);
    std::swap(diagonal[2], diagonal[3]);
    EXPECT_EQ(countSteps(diagonal, 2, 2).diagonal, 2u - 1u);
}

TEST(BucketOrder, tableOfNames) {
    std::string names;
    for (const BucketOrder& order : bucketOrders()) {
        names += std::string(order.name) + ' ';
        EXPECT_EQ(findBucketOrder(order.name), &order);
        EXPECT_FALSE(order.help.empty());
        EXPECT_EQ(order.isCorrelated, order.name == "correlated");
    }
    EXPECT_EQ(names, "hilbert row column diagonal spiral random correlated ");
    EXPECT_EQ(findBucketOrder("row")->cells(3, 2, 0), (Cells{0, 1, 2, 3, 4, 5}));
    EXPECT_EQ(findBucketOrder("column")->cells(3, 2, 0), (Cells{0, 3, 1, 4, 2, 5}));
    EXPECT_EQ(findBucketOrder("random")->cells(9, 7, 5), randomOrder(9, 7, 5));
    EXPECT_EQ(findBucketOrder("peano"), nullptr);
    EXPECT_EQ(findBucketOrder("Hilbert"), nullptr);
    EXPECT_EQ(findBucketOrder(""), nullptr);
}

}  // namespace
}  // namespace pm
