// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "scheduler/film/correlated_choice.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <limits>
#include <thread>

#include "scheduler/buckets/hilbert_order.h"
#include "scheduler/buckets/static_orders.h"

namespace pm {
namespace {

constexpr std::size_t kFloats = 4, kFirst = 1;  // floats a pixel, and where the three begin

// The pixels of a bucket: value(x, y) in the three channels, something else in the fourth.
template <typename Value>
std::vector<float> pixelsOf(const Rect& rect, Value value) {
    std::vector<float> pixels;
    for (std::int32_t y = rect.y0; y < rect.y1; ++y) {
        for (std::int32_t x = rect.x0; x < rect.x1; ++x) {
            const auto v = static_cast<float>(value(x, y));
            pixels.insert(pixels.end(), {-7.0f, v, v, v});
        }
    }
    return pixels;
}

// The cells in the order in which one worker renders the whole picture.
template <typename Value>
std::vector<std::uint32_t> walk(const BucketGrid& grid, const std::vector<std::uint32_t>& order,
                                Value value) {
    CorrelatedChoice choice(grid, order, 1);
    std::vector<std::uint32_t> cells;
    for (std::size_t place = choice.next(0); place < order.size(); place = choice.next(0)) {
        cells.push_back(order[place]);
        choice.finished(order[place], pixelsOf(grid.cellRect(order[place]), value), kFloats,
                        kFirst);
    }
    EXPECT_EQ(choice.next(0), order.size()) << "and none from then on";
    return cells;
}

std::vector<std::uint32_t> sorted(std::vector<std::uint32_t> cells) {
    std::sort(cells.begin(), cells.end());
    return cells;
}

std::uint32_t noise(std::int32_t x, std::int32_t y) {
    std::uint32_t h = static_cast<std::uint32_t>(x) * 0x9e3779b9u + static_cast<std::uint32_t>(y);
    h = (h ^ (h >> 16)) * 0x7feb352du;
    return (h ^ (h >> 15)) % 1000;
}

// Where all edges agree alike, the order is the one given: Hilbert's next is always a neighbour.
TEST(CorrelatedChoice, isTheGivenOrderOnAFlatPicture) {
    for (const Rect& window : {Rect{0, 0, 203, 97}, Rect{-11, 5, 60, 300}, Rect{0, 0, 8, 8}}) {
        const BucketGrid grid(window, 16);
        const auto order = hilbertOrder(grid.columns(), grid.rows());
        EXPECT_EQ(walk(grid, order, [](int, int) { return 0.25; }), order);
        EXPECT_EQ(walk(grid, order, [](int, int) { return 0.0; }), order);
    }
}

TEST(CorrelatedChoice, everyBucketOnceOnAnyPicture) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    for (std::int32_t rows = 1; rows <= 9; ++rows) {
        for (std::int32_t columns = 1; columns <= 9; ++columns) {
            const BucketGrid grid({3, -2, 3 + columns * 8, -2 + rows * 8}, 8);
            const auto order = hilbertOrder(grid.columns(), grid.rows());
            const auto all = rowOrder(grid.columns(), grid.rows());
            EXPECT_EQ(sorted(walk(grid, order, noise)), all) << columns << " x " << rows;
            EXPECT_EQ(sorted(walk(grid, order, [&](int, int) { return nan; })), all);
        }
    }
}

// A part of an order: what is not in it is never chosen.
TEST(CorrelatedChoice, staysWithinAPart) {
    const BucketGrid grid({0, 0, 80, 80}, 8);
    const auto whole = hilbertOrder(10, 10);
    const std::vector<std::uint32_t> part(whole.begin() + 20, whole.begin() + 61);
    EXPECT_EQ(sorted(walk(grid, part, noise)), sorted(part));
}

// Three by three buckets in row order. Around the worker's last one, the middle, wait the one above
// and the one to the right; each has one more finished neighbour.
class BetweenTwo : public ::testing::Test {
  protected:
    static constexpr std::uint32_t kAbove = 1, kRight = 5, kMiddle = 4;

    // The cell chosen after the middle, where the neighbours of `kAbove` and `kRight` have these
    // brightnesses and the middle 1.
    std::uint32_t chosen(float besideAbove, float besideRight) {
        const BucketGrid grid({0, 0, 24, 24}, 8);
        const std::vector<std::uint32_t> order{0, 8, 3, 7, kMiddle, kRight, kAbove};
        CorrelatedChoice choice(grid, order, 3);
        for (const int worker : {0, 1, 0, 1}) choice.next(worker);
        const auto finish = [&](std::uint32_t cell, float value) {
            choice.finished(cell, pixelsOf(grid.cellRect(cell), [=](int, int) { return value; }),
                            kFloats, kFirst);
        };
        finish(0, besideAbove);
        finish(8, besideRight);
        EXPECT_EQ(order[choice.next(2)], kMiddle);
        finish(kMiddle, 1.0f);
        return order[choice.next(2)];
    }
};

TEST_F(BetweenTwo, edgesThatAgreeBestAreNext) {
    EXPECT_EQ(chosen(1.0f, 5.0f), kAbove);
    EXPECT_EQ(chosen(5.0f, 1.0f), kRight);
    EXPECT_EQ(chosen(1.1f, 0.8f), kAbove);
    EXPECT_EQ(chosen(0.7f, 1.2f), kRight);
    EXPECT_EQ(chosen(1.0f, 1.0f), kRight) << "as good: the first in the order";
}

// A flat edge agrees with itself, a mixed one does not: of the middle's four only one is flat, for
// each side in turn.
TEST(CorrelatedChoice, theFlatEdgeIsCrossed) {
    const BucketGrid grid({0, 0, 24, 24}, 8);
    const std::vector<std::uint32_t> order{4, 1, 3, 5, 7};
    const Rect middle = grid.cellRect(4);
    const Rect edges[] = {{middle.x0, middle.y0, middle.x1, middle.y0 + 1},
                          {middle.x0, middle.y0, middle.x0 + 1, middle.y1},
                          {middle.x1 - 1, middle.y0, middle.x1, middle.y1},
                          {middle.x0, middle.y1 - 1, middle.x1, middle.y1}};
    for (std::size_t side = 0; side < 4; ++side) {
        CorrelatedChoice choice(grid, order, 1);
        EXPECT_EQ(order[choice.next(0)], 4u);
        const auto value = [&](std::int32_t x, std::int32_t y) {
            return edges[side].contains(x, y) ? 500.0 : static_cast<double>(noise(x, y));
        };
        choice.finished(4, pixelsOf(middle, value), kFloats, kFirst);
        EXPECT_EQ(order[choice.next(0)], order[side + 1]);
        const std::uint32_t firstLeft = side == 0 ? 3 : 1;
        EXPECT_EQ(order[choice.next(0)], firstLeft) << "nothing finished is beside";
    }
}

// What caches lack counts before edges, and edges only where nobody knows of it.
TEST(CorrelatedChoice, leastMissingIsNext) {
    const BucketGrid grid({0, 0, 24, 24}, 8);
    const std::vector<std::uint32_t> order{4, 1, 3, 5, 7};
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const auto chosen = [&](const std::array<float, 9>& missing) {
        CorrelatedChoice choice(grid, order, 1, [&](std::uint32_t cell) { return missing[cell]; });
        EXPECT_EQ(order[choice.next(0)], 4u);
        // Noise, but for the flat edge to cell 7: by edges, that would be next.
        choice.finished(4,
                        pixelsOf(grid.cellRect(4),
                                 [](int x, int y) {
                                     return y == 15 ? 500.0 : static_cast<double>(noise(x, y));
                                 }),
                        kFloats, kFirst);
        return order[choice.next(0)];
    };
    EXPECT_EQ(chosen({nan, nan, nan, nan, nan, nan, nan, nan, nan}), 7u);
    EXPECT_EQ(chosen({1, .5f, 1, .25f, 1, .75f, 1, .5f, 1}), 3u);
    EXPECT_EQ(chosen({1, .5f, 1, .5f, 1, .1f, 1, .5f, 1}), 5u);
    EXPECT_EQ(chosen({1, 1, 1, 1, 1, 1, 1, 1, 1}), 1u) << "as good: the first in the order";
    EXPECT_EQ(chosen({1, 1, 1, 1, 1, 1, 1, nan, 1}), 7u) << "what is not known counts by edges";
}

TEST(CorrelatedChoice, everyBucketOnceForManyWorkers) {
    constexpr int kWorkers = 8;
    const BucketGrid grid({0, 0, 320, 240}, 8);
    const auto order = hilbertOrder(grid.columns(), grid.rows());
    CorrelatedChoice choice(grid, order, kWorkers);
    std::vector<std::vector<std::uint32_t>> drawn(kWorkers);
    std::vector<std::thread> threads;
    for (int worker = 0; worker < kWorkers; ++worker) {
        threads.emplace_back([&, worker] {
            auto& mine = drawn[static_cast<std::size_t>(worker)];
            for (std::size_t p = choice.next(worker); p < order.size(); p = choice.next(worker)) {
                mine.push_back(order[p]);
                choice.finished(order[p], pixelsOf(grid.cellRect(order[p]), noise), kFloats,
                                kFirst);
            }
        });
    }
    for (std::thread& thread : threads) thread.join();
    std::vector<std::uint32_t> all;
    for (const auto& mine : drawn) all.insert(all.end(), mine.begin(), mine.end());
    EXPECT_EQ(sorted(all), rowOrder(grid.columns(), grid.rows()));
}

}  // namespace
}  // namespace pm
