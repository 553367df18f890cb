// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Checkpoints on a disk that takes its time or fails: nobody who renders waits for it.
#include <sys/syscall.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <chrono>
#include <functional>
#include <thread>

#include "tests/pieces/piece_host.h"

namespace {

enum class Disk { kWell, kStuck, kFails };
std::atomic<Disk> s_disk{Disk::kWell};
std::atomic<int> s_stuck{0};
// The beginning of a checkpoint is synced before the render begins; from the next one on the disk
// is as it is.
std::atomic<int> s_well{1};

void nap() {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

}  // namespace

// The library, loaded into this program, finds this one before the system's.
extern "C" __attribute__((visibility("default"))) int fdatasync(int file) {
    const bool isWell = s_disk == Disk::kWell || s_well.fetch_sub(1) > 0;
    if (!isWell && s_disk == Disk::kStuck) {
        ++s_stuck;
        while (s_disk == Disk::kStuck) nap();
        --s_stuck;
    } else if (!isWell) {
        errno = EIO;
        return -1;
    }
    return static_cast<int>(syscall(SYS_fdatasync, file));
}

namespace pm::test {

namespace {

class SlowDisk : public PieceHost {
  protected:
    void SetUp() override {
        PieceHost::SetUp();
        s_well = 1;
        m_settings["checkpoint"] = path("c");
        m_settings["resume"] = std::string("1");
        m_settings["threads"] = std::string("1");
    }
    void TearDown() override {
        s_disk = Disk::kWell;
        PieceHost::TearDown();
    }
    PmrRender makeRender(const PmrRenderDesc& desc, const Settings& more) const {
        PmrRender render = nullptr;
        EXPECT_EQ(PMR_OK, api().createRender(m_host.scene(), &desc, &render));
        Settings all = m_settings;
        for (const auto& [name, value] : more) all[name] = value;
        for (const auto& [name, value] : all)
            EXPECT_EQ(PMR_OK, api().setSettingText(render, name.c_str(), value.c_str()));
        return render;
    }
    static void waitUntil(const std::function<bool()>& done) {
        for (int i = 0; i < 60000 && !done(); ++i) nap();
        EXPECT_TRUE(done());
    }
};

TEST_F(SlowDisk, StopsNoWorker) {
    std::atomic<int> buckets{0};
    PmrRenderDesc desc = PMR_INIT(PmrRenderDesc);
    desc.user = &buckets;
    desc.bucketFinished = [](void* user, PmrRender, const PmrBucketInfo*) {
        ++*static_cast<std::atomic<int>*>(user);
    };
    const PmrRender render = makeRender(desc, {{"passes", "1"}});
    s_disk = Disk::kStuck;
    ASSERT_EQ(PMR_OK, api().startRender(render));
    // All buckets of the pass, though the sync that the first one asked for is still on its way.
    waitUntil([&] { return buckets == 20; });
    EXPECT_EQ(1, s_stuck);
    // A picture is finished when all is on the disk.
    EXPECT_EQ(PMR_ERROR_TIMEOUT, api().waitRender(render, 0.05));
    s_disk = Disk::kWell;
    EXPECT_EQ(PMR_OK, api().waitRender(render, -1.0));
    EXPECT_EQ(PMR_OK, api().destroyRender(render));
}

TEST_F(SlowDisk, WhoCancelsDoesNotWait) {
    for (const char* passes : {"1", "100000"}) {
        s_well = 1;
        std::filesystem::remove(path("c"));
        const PmrRender render = makeRender(PMR_INIT(PmrRenderDesc), {{"passes", passes}});
        s_disk = Disk::kStuck;
        ASSERT_EQ(PMR_OK, api().startRender(render));
        // Within the passes, at the sums that follow some of them, or at the end.
        waitUntil([] { return s_stuck > 0; });
        nap();
        EXPECT_EQ(PMR_OK, api().cancelRender(render));
        const PmrStatus status = api().waitRender(render, 60.0);
        EXPECT_TRUE(status == PMR_ERROR_CANCELLED || status == PMR_OK) << status;
        EXPECT_EQ(1, s_stuck);
        // The checkpoint is free, and whole up to its last record.
        s_disk = Disk::kWell;
        EXPECT_EQ(PMR_OK, api().destroyRender(render));
    }
    m_settings["passes"] = std::string("2");
    std::filesystem::remove(path("c"));
    const Outcome whole = PieceHost::render({});
    EXPECT_TRUE(whole.isOk()) << whole.error;
}

TEST_F(SlowDisk, FailureIsTold) {
    s_disk = Disk::kFails;
    const Outcome outcome = PieceHost::render({});
    EXPECT_TRUE(outcome.isOk()) << outcome.error;
    EXPECT_NE(std::string::npos, outcome.warnings.find("goes on without checkpoint"))
        << outcome.warnings;
    EXPECT_NE(std::string::npos, outcome.warnings.find(path("c"))) << outcome.warnings;
    s_disk = Disk::kWell;
    expectSameBits(outcome, PieceHost::render({{"checkpoint", ""}, {"resume", "0"}}));
}

TEST_F(SlowDisk, FailureOfTheLastSyncIsTold) {
    s_well = 2;  // the beginning, and what the first bucket asks for
    s_disk = Disk::kFails;
    const Outcome outcome = PieceHost::render({{"passes", "1"}});
    EXPECT_TRUE(outcome.isOk()) << outcome.error;
    EXPECT_NE(std::string::npos, outcome.warnings.find(path("c"))) << outcome.warnings;
}

TEST_F(SlowDisk, PhotonsOfWhoCancelsDoNotWait) {
    const Settings photons = {
        {"checkpoint", ""}, {"resume", "0"}, {"photonMap", path("m")}, {"photonsOnly", "1"}};
    s_well = 0;
    const PmrRender render = makeRender(PMR_INIT(PmrRenderDesc), photons);
    s_disk = Disk::kStuck;
    ASSERT_EQ(PMR_OK, api().startRender(render));
    waitUntil([] { return s_stuck > 0; });
    // It has no name before all is on the disk.
    EXPECT_EQ(PMR_ERROR_TIMEOUT, api().waitRender(render, 0.05));
    EXPECT_FALSE(std::filesystem::exists(path("m")));
    EXPECT_EQ(PMR_OK, api().cancelRender(render));
    EXPECT_EQ(PMR_ERROR_CANCELLED, api().waitRender(render, 60.0));
    EXPECT_EQ(1, s_stuck);
    EXPECT_TRUE(files().empty());
    s_disk = Disk::kWell;
    EXPECT_EQ(PMR_OK, api().destroyRender(render));
    EXPECT_TRUE(files().empty());
}

TEST_F(SlowDisk, PhotonsThatDoNotReachItLeaveNothing) {
    s_well = 0;
    s_disk = Disk::kFails;
    const PmrRender render = makeRender(
        PMR_INIT(PmrRenderDesc),
        {{"checkpoint", ""}, {"resume", "0"}, {"photonMap", path("m")}, {"photonsOnly", "1"}});
    ASSERT_EQ(PMR_OK, api().startRender(render));
    EXPECT_EQ(PMR_ERROR_IO, api().waitRender(render, -1.0));
    EXPECT_EQ(PMR_OK, api().destroyRender(render));
    EXPECT_TRUE(files().empty());
}

}  // namespace

}  // namespace pm::test
