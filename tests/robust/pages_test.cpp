// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Photon maps that are larger than their share of memory, by the real pm_host: the picture of maps
// in memory, from pages that are read again and again; a killed render leaves nothing.
#include <sys/resource.h>

#include <chrono>
#include <nlohmann/json.hpp>
#include <thread>

#include "tests/robust/host_process.h"

namespace pm::host::test {
namespace {

class Pages : public HostProcess {
  protected:
    void SetUp() override {
        HostProcess::SetUp();
        fs::create_directory(path("scratch"));
    }
    // Global and caustic photons, and such as are descended from caustics.
    static std::vector<std::string> glass(const std::vector<std::string>& more) {
        std::vector<std::string> arguments{
            std::string(PM_SOURCE_DIR) + "/scenes/caustic_glass/caustic_glass.obj",
            "--size",
            "48x32",
            "--aa",
            "1",
            "--passes",
            "2",
            "--photons",
            "60000",
            "--scratch",
            "scratch",
            "-q",
            "--bucket-size",
            "16",
            "--stats",
            "s.json"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return arguments;
    }
    nlohmann::json statistics() const { return nlohmann::json::parse(readText(path("s.json"))); }
    void expectNothingLeft() const { EXPECT_TRUE(fs::is_empty(path("scratch"))); }
    static void expectSamePicture(const Picture& wanted, const Picture& found) {
        ASSERT_EQ(wanted.channels.size(), found.channels.size());
        for (std::size_t c = 0; c < wanted.channels.size(); ++c)
            EXPECT_TRUE(wanted.channels[c].values == found.channels[c].values)
                << wanted.channels[c].name;
    }
};

TEST_F(Pages, GiveThePictureOfMapsInMemory) {
    ASSERT_EQ(run(glass({"-o", "whole.exr"})).exitCode, 0);
    EXPECT_FALSE(statistics().contains("photonPages"));
    const nlohmann::json counters = statistics()["counters"];
    const Picture whole = readExr(path("whole.exr"));
    // Room for all, which tells how much there is.
    ASSERT_EQ(run(glass({"-o", "roomy.exr", "--photon-pages", "100"})).exitCode, 0);
    nlohmann::json pages = statistics()["photonPages"];
    EXPECT_EQ(pages["madeAgain"], 0);
    expectSamePicture(whole, readExr(path("roomy.exr")));
    const auto wholeBytes = pages["wholeBytes"].get<std::uint64_t>();
    const std::string few = std::to_string(static_cast<double>(wholeBytes) / 16 / 1048576);
    for (const std::uint64_t threads : {1, 2}) {
        const Outcome outcome = run(
            glass({"-o", "few.exr", "--photon-pages", few, "--threads", std::to_string(threads)}));
        ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
        expectSamePicture(whole, readExr(path("few.exr")));
        EXPECT_EQ(statistics()["counters"], counters);
        pages = statistics()["photonPages"];
        // Sites are filled before gather rays ask for them.
        EXPECT_GT(pages["missesOf"]["photon"], 0);
        const auto budget = pages["budgetBytes"].get<std::uint64_t>();
        EXPECT_GE(pages["wholeBytes"].get<std::uint64_t>(), 8 * budget);
        EXPECT_GE(pages["bytesRead"].get<std::uint64_t>(), 8 * budget);
        EXPECT_GT(pages["madeAgain"].get<std::uint64_t>(),
                  pages["misses"].get<std::uint64_t>() / 2);
        constexpr std::uint64_t kPage = 29'000;
        EXPECT_LE(pages["mostBytesHeld"].get<std::uint64_t>(), budget + 3 * threads * kPage);
        EXPECT_LE(pages["mostBuildBytes"].get<std::uint64_t>(), std::uint64_t{1} << 20);
    }
    expectNothingLeft();
}

// A limit that neither the frame's maps fit in nor those of all passes, bucket by bucket.
TEST_F(Pages, AreMadeWhereMapsDoNotFit) {
    const std::vector<std::string> many{"--photons", "1000000",      "--passes",
                                        "1",         "--time-limit", "900"};
    const auto with = [&](std::vector<std::string> more) {
        more.insert(more.begin(), many.begin(), many.end());
        return run(glass(more));
    };
    ASSERT_EQ(with({"-o", "whole.exr"}).exitCode, 0);
    const nlohmann::json memory = statistics()["memory"];
    double bytes = 0;
    for (const char* part : {"sceneBytes", "frameBytes", "bucketBytes", "processBytes"})
        bytes += memory[part].get<double>();
    const double maps = memory["plannedMapBytes"].get<double>();
    const auto limit = [&](double share) {
        return std::to_string((bytes + share * maps) / 1073741824);
    };
    const Outcome refused = with({"-o", "none.exr", "--memory-limit", limit(0.1)});
    EXPECT_EQ(refused.exitCode, 5);
    // With a third there is less room for sites, too.
    for (const double share : {0.7, 0.33}) {
        SCOPED_TRACE(share);
        const Outcome explained = with({"--explain", "--memory-limit", limit(share)});
        EXPECT_NE(explained.out.find("photon pages: of "), std::string::npos) << explained.out;
        const Outcome outcome = with({"-o", "paged.exr", "--memory-limit", limit(share)});
        ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
        EXPECT_GT(statistics()["photonPages"]["misses"].get<std::uint64_t>(), 0u);
        EXPECT_LT(statistics()["memory"]["mapBytes"].get<double>(), share * maps);
        expectSamePicture(readExr(path("whole.exr")), readExr(path("paged.exr")));
    }
}

// In rounds, not all of a pass at once.
TEST_F(Pages, TakePhotonsOfAFile) {
    const std::vector<std::string> map{"--photon-map", "photons.pm"};
    const auto with = [&](std::vector<std::string> more) {
        more.insert(more.begin(), map.begin(), map.end());
        return run(glass(more));
    };
    ASSERT_EQ(with({"--photons-only"}).exitCode, 0);
    ASSERT_EQ(run(glass({"-o", "whole.exr"})).exitCode, 0);
    const Outcome outcome = with({"-o", "few.exr", "--photon-pages", "0.3"});
    ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
    EXPECT_GT(statistics()["photonPages"]["madeAgain"].get<std::uint64_t>(), 0u);
    expectSamePicture(readExr(path("whole.exr")), readExr(path("few.exr")));
    // What was damaged since is found before it is in a map.
    std::fstream file(path("photons.pm"), std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(static_cast<std::streamoff>(fs::file_size(path("photons.pm")) / 2));
    file.put('x').put('y');
    file.close();
    const Outcome damaged = with({"-o", "none.exr", "--photon-pages", "0.3"});
    EXPECT_NE(damaged.exitCode, 0);
    EXPECT_NE(damaged.err.find("damaged at byte"), std::string::npos) << damaged.err;
}

TEST_F(Pages, AKilledRenderLeavesNothing) {
    const auto writes = [](pid_t child) {
        std::error_code gone;
        for (const auto& entry :
             fs::directory_iterator("/proc/" + std::to_string(child) + "/fd", gone)) {
            const std::string file = fs::read_symlink(entry.path(), gone).string();
            if (file.find("/scratch/") != std::string::npos &&
                fs::file_size(entry.path(), gone) > 1'000'000 && !gone)
                return true;
        }
        return false;
    };
    bool hasWritten = false;
    const Outcome killed = run(
        glass({"-o", "a.exr", "--photon-pages", "1", "--photons", "3000000"}), [&](pid_t child) {
            for (int tries = 0; tries < 6000 && !hasWritten; ++tries) {
                std::this_thread::sleep_for(std::chrono::milliseconds(10));
                hasWritten = writes(child);
            }
            kill(child, SIGKILL);
        });
    EXPECT_TRUE(hasWritten) << killed.err;
    EXPECT_EQ(killed.exitCode, 1000 + SIGKILL);
    expectNothingLeft();
    ASSERT_EQ(run(glass({"-o", "whole.exr"})).exitCode, 0);
    ASSERT_EQ(run(glass({"-o", "a.exr", "--photon-pages", "1"})).exitCode, 0);
    expectSamePicture(readExr(path("whole.exr")), readExr(path("a.exr")));
    expectNothingLeft();
}

TEST_F(Pages, SayWhatIsWrongWithTheFolderOrTheDisk) {
    expectRefusal(run(glass({"-o", "a.exr", "--photon-pages", "1", "--scratch", "nowhere"})), 4,
                  {"nowhere", "--scratch", "No such file or directory"});
    rlimit before{};
    ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
    const rlimit full{1'000'000, before.rlim_max};
    ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &full), 0);
    const Outcome outcome = run(glass({"-o", "a.exr", "--photon-pages", "1"}));
    ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &before), 0);
    EXPECT_EQ(outcome.exitCode, 4);
    EXPECT_NE(outcome.err.find("scratch: can't be written"), std::string::npos) << outcome.err;
    EXPECT_FALSE(fs::exists(path("a.exr")));
    expectNothingLeft();
}

}  // namespace
}  // namespace pm::host::test
