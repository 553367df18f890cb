// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Work that can't be told to stop, and who cancels doesn't wait for it.
#include "plugin/session/leave_behind.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <future>
#include <stdexcept>
#include <string>
#include <thread>

#include "integrator/values/error.h"
#include "plugin/values/forks.h"

namespace pm::plugin {

namespace {

TEST(LeaveBehind, GivesBackWhatWorkMakesAndThrows) {
    const std::atomic<bool> flag{false};
    const CancelCheck cancel(flag);
    const std::thread::id here = std::this_thread::get_id();
    EXPECT_NE(here, runLeavable(cancel, "asking", [](const CancelCheck& own) {
                  EXPECT_FALSE(own.isSet());
                  return std::this_thread::get_id();
              }));
    const auto fail = [](const CancelCheck&) -> int { throw std::runtime_error("no luck"); };
    EXPECT_THROW(runLeavable(cancel, "failing", fail), std::runtime_error);
}

TEST(LeaveBehind, BeginsNothingWhileCancelled) {
    const std::atomic<bool> flag{true};
    bool ran = false;
    try {
        runLeavable(CancelCheck(flag), "asking", [&](const CancelCheck&) { return ran = true; });
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(Status::kCancelled, error.status());
        EXPECT_NE(std::string::npos, std::string(error.what()).find("cancelled while asking"));
    }
    EXPECT_FALSE(ran);
}

// Work that looks at its check ends by itself, and is over when the call is.
TEST(LeaveBehind, WorkThatLooksUpIsWaitedFor) {
    std::atomic<bool> flag{false}, ended{false};
    const auto work = [&](const CancelCheck& own) -> int {
        flag = true;
        while (!own.isSet()) std::this_thread::yield();
        ended = true;
        own.throwIfSet("looking up");
        return 0;
    };
    try {
        runLeavable(CancelCheck(flag), "waiting", work);
        FAIL();
    } catch (const Error& error) {
        EXPECT_TRUE(ended);
        EXPECT_EQ(Status::kCancelled, error.status());
    }
}

struct Held {
    std::promise<void> mayEnd;
    std::atomic<bool> began{false}, ended{false};
};

// Returns though the work can't end before it has: a call that waited would wait for ever.
TEST(LeaveBehind, WorkThatDoesNotIsLeft) {
    const auto held = std::make_shared<Held>();
    std::atomic<bool> flag{false};
    std::thread other([&] {
        while (!held->began) std::this_thread::yield();
        flag = true;
    });
    const auto work = [held](const CancelCheck& own) -> int {
        held->began = true;
        held->mayEnd.get_future().wait();
        EXPECT_TRUE(own.isSet());  // though the caller's flag is not any more
        held->ended = true;
        return 0;
    };
    EXPECT_THROW(runLeavable(CancelCheck(flag), "holding", work), Error);
    other.join();
    EXPECT_FALSE(held->ended);

    // The next waits for it, and this wait can be cancelled.
    flag = false;
    std::thread impatient([&] { flag = true; });
    EXPECT_THROW(runLeavable(CancelCheck(flag), "following", [](const CancelCheck&) { return 1; }),
                 Error);
    impatient.join();
    flag = false;
    std::thread releaser([&] { held->mayEnd.set_value(); });
    EXPECT_TRUE(runLeavable(CancelCheck(flag), "following",
                            [held](const CancelCheck&) { return held->ended.load(); }));
    releaser.join();
}

// A child that is forked meanwhile has no such thread to wait for, at its next call or its end.
TEST(LeaveBehind, ChildWaitsForNone) {
#ifdef __SANITIZE_THREAD__
    GTEST_SKIP() << "ThreadSanitizer ends a forked child that starts threads";
#endif
    watchForks();
    const auto held = std::make_shared<Held>();
    std::atomic<bool> flag{false};
    std::thread other([&] {
        while (!held->began) std::this_thread::yield();
        flag = true;
    });
    const auto hold = [held](const CancelCheck&) {
        held->began = true;
        held->mayEnd.get_future().wait();
        return 0;
    };
    EXPECT_THROW(runLeavable(CancelCheck(flag), "holding", hold), Error);
    other.join();
    flag = false;
    const pid_t child = fork();
    if (child == 0) {
        alarm(20);
        _exit(runLeavable(CancelCheck(flag), "following", [](const CancelCheck&) { return 7; }));
    }
    int status = 0;
    waitpid(child, &status, 0);
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 7) << status;
    held->mayEnd.set_value();
}

}  // namespace

}  // namespace pm::plugin
