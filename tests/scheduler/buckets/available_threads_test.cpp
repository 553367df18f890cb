// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "scheduler/buckets/available_threads.h"

#include <gtest/gtest.h>

#include "integrator/values/error.h"
#include "scheduler/buckets/worker_arena.h"

#if defined(__linux__)
#include <sched.h>
#endif

namespace pm {
namespace {

#if defined(__linux__)
TEST(AvailableThreads, obeysAffinity) {
    EXPECT_GE(availableThreads(), 1);
    cpu_set_t saved;
    ASSERT_EQ(sched_getaffinity(0, sizeof saved, &saved), 0);
    EXPECT_LE(availableThreads(), CPU_COUNT(&saved));
    cpu_set_t one;
    CPU_ZERO(&one);
    for (int cpu = 0; cpu < CPU_SETSIZE && CPU_COUNT(&one) == 0; ++cpu) {
        if (CPU_ISSET(cpu, &saved)) CPU_SET(cpu, &one);
    }
    ASSERT_EQ(sched_setaffinity(0, sizeof one, &one), 0);
    EXPECT_EQ(availableThreads(), 1);
    ASSERT_EQ(sched_setaffinity(0, sizeof saved, &saved), 0);
}
#endif

TEST(WorkerArena, threadsAreWhatWasAskedFor) {
    EXPECT_EQ(WorkerArena(0).threads(), availableThreads());
    EXPECT_EQ(WorkerArena(3).threads(), 3);
    EXPECT_THROW(WorkerArena(-1), Error);
    EXPECT_THROW(WorkerArena(4097), Error);
}

// TBB warns on standard error when more workers are asked for than it has; a library of ours must
// not be the cause of prints in a host.
TEST(WorkerArena, printsNothingWithMoreThreadsThanProcessors) {
    ::testing::internal::CaptureStderr();
    WorkerArena arena(512);
    EXPECT_EQ(arena.execute([] { return 1; }), 1);
    EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
    EXPECT_EQ(arena.threads(), 512);
}

TEST(WorkerArena, returnsResultsAndPassesExceptions) {
    WorkerArena arena(2);
    EXPECT_EQ(arena.execute([] { return 42; }), 42);
    EXPECT_THROW(arena.execute([] { throw Error(Status::kInternal, "x"); }), Error);
}

}  // namespace
}  // namespace pm
