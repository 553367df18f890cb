// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// The thread that waits for disks.
#include "plugin/storage/disk_thread.h"

#include <gtest/gtest.h>

#include <future>
#include <stdexcept>
#include <vector>

namespace pm::plugin {

namespace {

const std::atomic<bool> kGoesOn{false}, kCancelled{true};

TEST(DiskThread, DoesItsWorkInOrder) {
    std::vector<int> done;
    DiskThread disk;
    EXPECT_TRUE(disk.isIdle());
    EXPECT_TRUE(disk.waitUntilIdle(kCancelled));
    for (int i = 0; i < 100; ++i) disk.give([&done, i] { done.push_back(i); });
    EXPECT_TRUE(disk.waitUntilIdle(kGoesOn));
    EXPECT_TRUE(disk.isIdle());
    ASSERT_EQ(100u, done.size());
    for (int i = 0; i < 100; ++i) EXPECT_EQ(i, done[static_cast<std::size_t>(i)]);
}

TEST(DiskThread, NobodyWaitsOnceCancelled) {
    std::promise<void> slow;
    bool ended = false;
    {
        DiskThread disk;
        disk.give([&] {
            slow.get_future().wait();
            ended = true;
        });
        EXPECT_FALSE(disk.isIdle());
        EXPECT_FALSE(disk.waitUntilIdle(kCancelled));
        EXPECT_FALSE(disk.isIdle());
        slow.set_value();
    }
    EXPECT_TRUE(ended);
}

TEST(DiskThread, TellsOfTheFirstTroubleOnce) {
    DiskThread disk;
    disk.give([] { throw std::runtime_error("no space"); });
    disk.give([] { throw std::runtime_error("no disk"); });
    EXPECT_TRUE(disk.waitUntilIdle(kGoesOn));
    EXPECT_EQ("no space", disk.takeTrouble());
    EXPECT_EQ("", disk.takeTrouble());
}

}  // namespace

}  // namespace pm::plugin
