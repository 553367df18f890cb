// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "plugin/storage/done_pixels.h"

#include <gtest/gtest.h>

namespace pm::plugin::test {

namespace {

TEST(DonePixels, CountsEachOnce) {
    DonePixels done({-4, 2, 12, 10});
    EXPECT_FALSE(done.hasAll({-4, 2, -3, 3}));
    done.add({-4, 2, 4, 6});
    done.add({0, 4, 8, 8});
    EXPECT_EQ(done.count(), 32u + 32u - 8u);
    EXPECT_TRUE(done.hasAll({-4, 2, 4, 6}));
    EXPECT_TRUE(done.hasAll({0, 4, 4, 8}));
    EXPECT_FALSE(done.hasAll({-4, 2, 5, 6}));
    EXPECT_TRUE(done.hasAny({7, 7, 12, 10}));
    EXPECT_FALSE(done.hasAny({8, 2, 12, 10}));
    // What is outside of the window doesn't count.
    done.add({-8, 2, -4, 99});
    EXPECT_EQ(done.count(), 56u);
    EXPECT_TRUE(done.hasAll({-8, 0, 4, 6}));
    done.clear();
    EXPECT_EQ(done.count(), 0u);
    EXPECT_FALSE(done.hasAny({-4, 2, 12, 10}));
    EXPECT_FALSE(done.hasAll({2, 3, 3, 4}));
}

}  // namespace

}  // namespace pm::plugin::test
