// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// SameBitsPairs.FullMatrix as a program for ./dev bench: all combinations, with --quick some.
#include <gtest/gtest.h>
#include <stdlib.h>

#include <algorithm>
#include <string>

int main(int count, char** arguments) {
    ::testing::InitGoogleTest(&count, arguments);
    ::testing::GTEST_FLAG(filter) = "SameBitsPairs.FullMatrix";
    const bool isQuick =
        std::find(arguments, arguments + count, std::string("--quick")) != arguments + count;
    // A prime: every level of every factor is met.
    setenv("PM_FULL_MATRIX", isQuick ? "97" : "1", /*overwrite=*/0);
    return RUN_ALL_TESTS();
}
