// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "tests/determinism/covering_set.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace pm::test {

namespace {

bool isAnything(const Combination&) {
    return true;
}

// What holds of every covering set: all its members are of the matrix, all pairs of the matrix
// occur, and not without the member that was chosen last.
void expectCovers(const Combinations& matrix) {
    Combinations set = coveringSet(matrix);
    ASSERT_FALSE(set.empty());
    for (const Combination& member : set) EXPECT_TRUE(std::ranges::binary_search(matrix, member));
    EXPECT_EQ(pairsOf(set), pairsOf(matrix));
    set.pop_back();
    EXPECT_NE(pairsOf(set), pairsOf(matrix));
}

TEST(CoveringSet, MatricesAreWhole) {
    const Combinations matrix = fullMatrix({2, 1, 3}, isAnything);
    EXPECT_EQ(matrix,
              (Combinations{{0, 0, 0}, {0, 0, 1}, {0, 0, 2}, {1, 0, 0}, {1, 0, 1}, {1, 0, 2}}));
    // 2 x 1 + 2 x 3 + 1 x 3
    EXPECT_EQ(pairsOf(matrix).size(), 11u);
}

TEST(CoveringSet, TwoFactorsAreTheirMatrix) {
    const Combinations matrix = fullMatrix({4, 5}, isAnything);
    EXPECT_EQ(coveringSet(matrix).size(), matrix.size());
}

// The two largest factors alone need 35.
TEST(CoveringSet, IsSmall) {
    EXPECT_LE(coveringSet(fullMatrix({4, 5, 7, 3, 2, 2}, isAnything)).size(), 38u);
}

TEST(CoveringSet, CoversRandomFactors) {
    std::mt19937 random(20260501);
    for (int trial = 0; trial < 20; ++trial) {
        std::vector<int> levels(2 + random() % 4);
        for (int& count : levels) count = static_cast<int>(1 + random() % 4);
        expectCovers(fullMatrix(levels, isAnything));
    }
}

TEST(CoveringSet, LeavesOutWhatIsNotAllowed) {
    const Combinations matrix =
        fullMatrix({3, 4, 2, 2}, [](const Combination& c) { return !(c[0] == 2 && c[3] == 1); });
    EXPECT_FALSE(pairsOf(matrix).contains({0, 2, 3, 1}));
    expectCovers(matrix);
}

}  // namespace

}  // namespace pm::test
