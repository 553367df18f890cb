// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Work that can't be interrupted, and somebody who asks meanwhile whether to go on.
#include "host_shim/colour/asked_work.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <future>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>

namespace pm::host {
namespace {

TEST(AskedWork, givesBackWhatWorkMakesAndThrows) {
    EXPECT_EQ(runAsking({}, [] { return 7; }), 7);
    EXPECT_EQ(runAsking([] {}, [] { return std::string("made"); }), "made");
    EXPECT_THROW(callAsking([] {}, [] { throw std::runtime_error("no luck"); }),
                 std::runtime_error);
}

TEST(AskedWork, asksAgainAndAgain) {
    std::atomic<int> asked{0};
    callAsking([&] { ++asked; },
               [&] {
                   while (asked < 3) std::this_thread::yield();
               });
    EXPECT_GE(asked, 3);
}

// A call that waited for the work would wait for ever.
TEST(AskedWork, isLeftBehindWhenTheAnswerIsNo) {
    struct Held {
        std::promise<void> mayEnd, ended;
        std::atomic<bool> began{false};
    };
    const auto held = std::make_shared<Held>();
    const auto stop = [held] {
        if (held->began) throw std::runtime_error("stop");
    };
    EXPECT_THROW(callAsking(stop,
                            [held] {
                                held->began = true;
                                held->mayEnd.get_future().wait();
                                held->ended.set_value();
                            }),
                 std::runtime_error);
    auto ended = held->ended.get_future();
    EXPECT_EQ(ended.wait_for(std::chrono::milliseconds(1)), std::future_status::timeout);
    held->mayEnd.set_value();
    ended.wait();
}

}  // namespace
}  // namespace pm::host
