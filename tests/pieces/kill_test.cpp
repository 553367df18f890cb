// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// pm_host killed again and again, as a farm may do it: each render that is gone on with gives the
// bytes of one that was left alone. PM_KILLS=100 kills so many times.
#include <chrono>
#include <nlohmann/json.hpp>
#include <random>
#include <string>
#include <thread>
#include <utility>

#include "tests/robust/host_process.h"

namespace pm::host::test {
namespace {

using Clock = std::chrono::steady_clock;

class Kill : public HostProcess {
  protected:
    std::vector<std::string> command(std::vector<std::string> more) const {
        std::vector<std::string> arguments{"box.obj",  "--size", "64x48",     "--passes",   "12",
                                           "--aa",     "3",      "--photons", "3000",       "--aov",
                                           "N,stderr", "-o",     "a.exr",     "--progress", "none"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return arguments;
    }
    // What a run leaves under its final name; removed.
    std::string takePicture() const {
        std::string bytes = readText(path("a.exr"));
        fs::remove(path("a.exr"));
        return bytes;
    }
    // Until a run says so; most of a small render's time is the start of its process.
    void waitFor(const std::string& text) const {
        for (int i = 0; i < 5000 && readText(path(".err")).find(text) == std::string::npos; ++i)
            std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    // A render that nobody disturbs. Returns the time that its passes take, and its picture.
    std::pair<Clock::duration, std::string> undisturbed() const {
        Clock::time_point start;
        const Outcome outcome = run(command({}), [&](pid_t) {
            waitFor("pass 1 of");
            start = Clock::now();
        });
        EXPECT_EQ(outcome.exitCode, 0) << outcome.err;
        return {Clock::now() - start, takePicture()};
    }
};

TEST_F(Kill, AtAnyMomentCostsNoBit) {
    const auto [time, reference] = undisturbed();
    ASSERT_GT(reference.size(), 1000u);
    const char* wanted = std::getenv("PM_KILLS");
    const int kills = wanted != nullptr ? std::atoi(wanted) : 20;
    std::mt19937 random(3);
    int killed = 0, finished = 0, goneOn = 0;
    for (int i = 0; killed < kills && i < 20 * kills; ++i) {
        goneOn += fs::exists(path("c"));
        // Every fourth time it is left alone, to see what became of it.
        const bool rests = i % 4 == 3;
        const std::vector<std::string> sizes{"8", "16", "32", "64"}, threads{"1", "2", "3"};
        const std::string size = sizes[random() % 4], count = threads[random() % 3];
        const double share = std::uniform_real_distribution(0.0, 0.6)(random);
        fs::remove(path(".err"));
        const std::vector<std::string> arguments =
            command({"--checkpoint", "c", "--resume", "--bucket-size", size, "--threads", count});
        const Outcome outcome = run(arguments, [&, time = time](pid_t child) {
            if (rests) return;
            waitFor("pass ");
            std::this_thread::sleep_for(share * time);
            kill(child, SIGKILL);
        });
        if (outcome.exitCode == 1000 + SIGKILL) {
            ++killed;
            continue;
        }
        ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
        ++finished;
        ASSERT_TRUE(takePicture() == reference) << "after " << killed << " kills";
    }
    const Outcome last = run(command({"--checkpoint", "c", "--resume"}));
    ASSERT_EQ(last.exitCode, 0) << last.err;
    EXPECT_TRUE(takePicture() == reference);
    EXPECT_EQ(killed, kills);
    EXPECT_GT(goneOn, kills / 2);
    EXPECT_GT(finished, kills / 5);
    // All is tidied up: nothing is left but what was being written when a kill came.
    for (const std::string& name : leftFiles())
        EXPECT_TRUE(name.starts_with("a.exr.tmp.") || name.starts_with("c.tmp.")) << name;
    std::cout << killed << " kills of a render whose passes take "
              << std::chrono::duration<double>(time).count() << " s, " << goneOn
              << " runs went on from a checkpoint, " << finished << " finished between kills\n";
}

TEST_F(Kill, InterruptsLeaveAPartialPictureAndTheCheckpoint) {
    const std::string reference = undisturbed().second;
    // Each time it gets a little further: the same command line goes on.
    for (const int signal : {SIGINT, SIGTERM}) {
        fs::remove(path(".err"));
        const Outcome outcome = run(command({"--checkpoint", "c", "--resume"}), [&](pid_t child) {
            waitFor(signal == SIGINT ? "pass 2 of" : "pass ");
            kill(child, signal);
        });
        EXPECT_EQ(outcome.exitCode, 128 + signal) << outcome.err;
        EXPECT_EQ(leftFiles(), (std::vector<std::string>{"a.partial.exr", "c"}));
    }
    ASSERT_EQ(run(command({"--checkpoint", "c", "--resume"})).exitCode, 0);
    EXPECT_TRUE(takePicture() == reference);
    EXPECT_EQ(leftFiles(), (std::vector<std::string>{"a.partial.exr"}));
}

}  // namespace
}  // namespace pm::host::test
