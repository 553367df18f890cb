// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "scheduler/buckets/bucket_grid.h"

#include <gtest/gtest.h>

#include <vector>

#include "integrator/values/error.h"

namespace pm {
namespace {

const std::vector<Rect> kWindows{
    {0, 0, 64, 64},  {0, 0, 1, 1},        {0, 0, 97, 71}, {5, 3, 40, 90}, {-13, -7, 50, 33},
    {-8, -16, 0, 0}, {-100, -50, -1, -3}, {7, 8, 8, 9},   {-1, -1, 1, 1}, {1023, 2047, 1100, 2060}};

// How often each pixel of the window is covered by the cells; a pixel outside fails at once.
std::vector<int> coverage(const BucketGrid& grid) {
    const Rect w = grid.window();
    std::vector<int> count(static_cast<std::size_t>(w.area()));
    for (std::uint32_t cell = 0; cell < grid.cellCount(); ++cell) {
        const Rect r = grid.cellRect(cell);
        EXPECT_FALSE(r.empty()) << "cell " << cell;
        EXPECT_EQ(intersect(r, w), r) << "cell " << cell;
        EXPECT_LE(r.area(), grid.maxCellArea());
        for (std::int32_t y = r.y0; y < r.y1; ++y) {
            for (std::int32_t x = r.x0; x < r.x1; ++x) {
                ++count[static_cast<std::size_t>(y - w.y0) * static_cast<std::size_t>(w.width()) +
                        static_cast<std::size_t>(x - w.x0)];
            }
        }
    }
    return count;
}

TEST(BucketGrid, coversEveryPixelOnce) {
    for (const Rect& window : kWindows) {
        for (const std::int32_t size : {8, 16, 24, 32, 48, 1024}) {
            const BucketGrid grid(window, size);
            for (const int count : coverage(grid)) ASSERT_EQ(count, 1) << "size " << size;
        }
    }
}

TEST(BucketGrid, cellsAreUnionsOfAtomsClippedToTheWindow) {
    for (const Rect& window : kWindows) {
        for (const std::int32_t size : {8, 16, 24, 32, 48}) {
            const BucketGrid grid(window, size);
            for (std::uint32_t cell = 0; cell < grid.cellCount(); ++cell) {
                const Rect r = grid.cellRect(cell);
                // No atom is shared by two cells: the atoms of this one, clipped, are just it.
                EXPECT_EQ(intersect(wholeAtoms(r), window), r);
            }
        }
    }
}

TEST(BucketGrid, wholeAtomsRoundsOutwardsAlsoBelowZero) {
    EXPECT_EQ(wholeAtoms({0, 0, 8, 8}), (Rect{0, 0, 8, 8}));
    EXPECT_EQ(wholeAtoms({1, 7, 9, 16}), (Rect{0, 0, 16, 16}));
    EXPECT_EQ(wholeAtoms({-1, -8, 1, -7}), (Rect{-8, -8, 8, 0}));
    EXPECT_EQ(wholeAtoms({-9, -17, -8, -9}), (Rect{-16, -24, -8, -8}));
    EXPECT_TRUE(wholeAtoms({3, 3, 3, 9}).empty());
}

TEST(BucketGrid, atomsOfABucketCoverItOnceAndLieOnTheGrid) {
    for (const Rect& bucket : {Rect{0, 0, 32, 32}, Rect{-13, 5, 3, 16}, Rect{7, -9, 8, 40}}) {
        const std::int32_t count = atomCount(bucket);
        EXPECT_EQ(count * kAtomPixels, wholeAtoms(bucket).area());
        std::int64_t area = 0;
        for (std::int32_t i = 0; i < count; ++i) {
            const Rect atom = atomOf(bucket, i), whole = wholeAtoms(atom);
            EXPECT_EQ(whole.area(), kAtomPixels) << "one atom";
            EXPECT_EQ(intersect(whole, bucket), atom);
            for (std::int32_t j = 0; j < i; ++j)
                EXPECT_TRUE(intersect(atomOf(bucket, j), atom).empty());
            area += atom.area();
        }
        EXPECT_EQ(area, bucket.area());
    }
}

TEST(BucketGrid, automaticSizeKeepsBucketsToSomeTensOfThousands) {
    EXPECT_EQ(autoBucketSize({0, 0, 1, 1}), 32);
    EXPECT_EQ(autoBucketSize({3, 4, 3, 9}), 32);
    EXPECT_EQ(autoBucketSize({0, 0, 8192, 8192}), 32);  // 65,536 of them
    EXPECT_EQ(autoBucketSize({0, 0, 8193, 8192}), 64);
    EXPECT_EQ(autoBucketSize({-1, 0, 8184, 8192}), 32);  // from -8: 256 columns
    EXPECT_EQ(autoBucketSize({-1, 0, 8185, 8192}), 64);
    EXPECT_EQ(autoBucketSize({0, 0, 65536, 65536}), 256);
    EXPECT_EQ(autoBucketSize({-(1 << 29), 0, 1 << 29, 1 << 29}), kMaxBucketSizePixels);
}

TEST(BucketGrid, columnsAndRows) {
    const BucketGrid grid({-13, 5, 50, 33}, 16);  // origin (-16, 0)
    EXPECT_EQ(grid.columns(), 5);                 // -16, 0, 16, 32, 48
    EXPECT_EQ(grid.rows(), 3);                    // 0, 16, 32
    EXPECT_EQ(grid.cellRect(0), (Rect{-13, 5, 0, 16}));
    EXPECT_EQ(grid.cellRect(6), (Rect{0, 16, 16, 32}));
    EXPECT_EQ(grid.cellRect(14), (Rect{48, 32, 50, 33}));
}

TEST(BucketGrid, emptyWindowHasNoCells) {
    const BucketGrid grid({3, 4, 3, 9}, 32);
    EXPECT_EQ(grid.cellCount(), 0u);
    EXPECT_EQ(grid.maxCellArea(), 0);
}

TEST(BucketGrid, refusesWhatIsNotAllowed) {
    const Rect window{0, 0, 64, 64};
    for (const std::int32_t size : {-8, 0, 1, 4, 7, 12, 33, 1032}) {
        EXPECT_THROW(BucketGrid(window, size), Error) << size;
    }
    EXPECT_THROW(BucketGrid({0, 0, 2'000'000'000, 8}, 8), Error);
    EXPECT_THROW(BucketGrid({0, 0, 1 << 29, 1 << 29}, 8), Error);  // 2^52 buckets
    EXPECT_NO_THROW(BucketGrid({-(1 << 29), 0, 1 << 29, 8}, 1024));
}

}  // namespace
}  // namespace pm
