// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "scheduler/buckets/cgroup_limits.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

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
    CgroupPlaces places() const {
        return {(m_root / "cgroup").string(), (m_root / "sys").string()};
    }
    std::optional<double> limit() const { return cgroupProcessorLimit(places()); }
    std::optional<std::uint64_t> memoryLimit() const { return cgroupMemoryLimit(places()); }

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
    write("sys/memory.max", "-1\n");
    EXPECT_EQ(memoryLimit(), std::nullopt);
    write("sys/memory.max", "\n");
    EXPECT_EQ(memoryLimit(), std::nullopt);
}

TEST_F(CgroupTree, groupsOutsideOfTheRootAreNotLookedFor) {
    write("cgroup", "0::/../b\n");
    write("b/cpu.max", "100000 100000\n");
    write("sys/cpu.max", "200000 100000\n");
    EXPECT_EQ(limit(), 2.0);
}

TEST_F(CgroupTree, memoryOfVersionTwoIsTheLeastUpToTheRoot) {
    write("cgroup", "0::/a/b/c\n");
    write("sys/a/b/c/memory.max", "max\n");
    EXPECT_EQ(memoryLimit(), std::nullopt);
    write("sys/a/b/memory.max", "5368709120\n");
    write("sys/a/memory.max", "4294967296\n");
    EXPECT_EQ(memoryLimit(), 4294967296u);
    write("sys/memory.max", "1073741824\n");
    EXPECT_EQ(memoryLimit(), 1073741824u);
    EXPECT_EQ(limit(), std::nullopt);
}

TEST_F(CgroupTree, memoryOfVersionOneIsInAFolderOfItsOwn) {
    write("cgroup", "5:memory:/m\n4:cpu,cpuacct:/a\n0::/\n");
    write("sys/memory/memory.limit_in_bytes", "9223372036854771712\n");
    EXPECT_EQ(memoryLimit(), 9223372036854771712u);
    write("sys/memory/m/memory.limit_in_bytes", "4096\n");
    EXPECT_EQ(memoryLimit(), 4096u);
}

}  // namespace
}  // namespace pm
