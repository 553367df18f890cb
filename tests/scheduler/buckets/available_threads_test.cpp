// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "scheduler/buckets/available_threads.h"

#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "integrator/values/error.h"
#include "scheduler/buckets/worker_arena.h"

#if defined(__linux__)
#include <sched.h>
#endif

namespace pm {
namespace {

namespace fs = std::filesystem;

// A made-up /sys/fs/cgroup and /proc/self/cgroup in a folder of the test's own.
class CgroupTree : public ::testing::Test {
  protected:
    void SetUp() override {
        const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
        m_root = fs::path(::testing::TempDir()) / (std::string("pm_cgroup_") + test->name());
        fs::remove_all(m_root);
        fs::create_directories(m_root);
    }
    void TearDown() override { fs::remove_all(m_root); }

    void write(const std::string& file, const std::string& text) const {
        fs::create_directories((m_root / file).parent_path());
        std::ofstream(m_root / file) << text;
    }
    std::optional<double> limit() const {
        return cgroupProcessorLimit(m_root / "cgroup", m_root / "sys");
    }

    fs::path m_root;
};

TEST_F(CgroupTree, noneIsNoLimit) {
    EXPECT_EQ(limit(), std::nullopt);
    write("cgroup", "0::/a/b\n");
    EXPECT_EQ(limit(), std::nullopt);
    write("sys/a/b/cpu.max", "max 100000\n");
    EXPECT_EQ(limit(), std::nullopt);
}

TEST_F(CgroupTree, versionTwoTakesTheLeastUpToTheRoot) {
    write("cgroup", "0::/a/b\n");
    write("sys/a/b/cpu.max", "max 100000\n");
    write("sys/a/cpu.max", "250000 100000\n");
    EXPECT_EQ(limit(), 2.5);
    write("sys/cpu.max", "50000 100000\n");
    EXPECT_EQ(limit(), 0.5);
}

TEST_F(CgroupTree, versionOneReadsQuotaAndPeriod) {
    write("cgroup", "5:memory:/m\n3:cpuset:/s\n4:cpu,cpuacct:/a\n0::/\n");
    write("sys/cpu,cpuacct/a/cpu.cfs_quota_us", "-1\n");
    write("sys/cpu,cpuacct/a/cpu.cfs_period_us", "100000\n");
    EXPECT_EQ(limit(), std::nullopt);
    write("sys/cpu,cpuacct/a/cpu.cfs_quota_us", "300000\n");
    EXPECT_EQ(limit(), 3.0);
}

TEST_F(CgroupTree, containerSeesItsOwnGroupAsRoot) {
    write("cgroup", "1:cpu:/docker/0123\n");  // a path of the host, not there in the container
    write("sys/cpu/cpu.cfs_quota_us", "150000\n");
    write("sys/cpu/cpu.cfs_period_us", "100000\n");
    EXPECT_EQ(limit(), 1.5);
}

TEST_F(CgroupTree, rubbishIsNoLimit) {
    write("cgroup", "\nx\n0:\n0::/../../etc\n0::/a\n");
    write("sys/a/cpu.max", "many 100000\n");
    write("sys/cpu.max", "100000\n");
    EXPECT_EQ(limit(), std::nullopt);
    write("sys/cpu.max", "100000 0\n");
    EXPECT_EQ(limit(), std::nullopt);
}

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
