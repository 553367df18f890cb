// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/colour/asked_work.h"

#include <chrono>
#include <cstdlib>
#include <future>
#include <mutex>
#include <thread>
#include <vector>

namespace pm::host {
namespace {

struct LeftThreads {
    std::mutex mutex;
    std::vector<std::thread> threads;
};

// Never destroyed: threads may end after static objects do.
LeftThreads& leftThreads() {
    static LeftThreads& left = *new LeftThreads;
    return left;
}

void joinLeft() {
    const std::lock_guard lock(leftThreads().mutex);
    for (std::thread& left : leftThreads().threads) left.join();
    leftThreads().threads.clear();
}

// Libraries crash whose statics are destroyed under them; those made until now are after this.
void leave(std::thread thread) {
    std::atexit(joinLeft);
    const std::lock_guard lock(leftThreads().mutex);
    leftThreads().threads.push_back(std::move(thread));
}

}  // namespace

void callAsking(const std::function<void()>& goOn, std::function<void()> work) {
    constexpr std::chrono::milliseconds kBetweenQuestions{10};
    if (goOn) goOn();
    joinLeft();  // it may write the same file
    std::packaged_task<void()> task(std::move(work));
    std::future<void> result = task.get_future();
    std::thread thread([task = std::move(task)]() mutable { task(); });
    try {
        while (result.wait_for(kBetweenQuestions) != std::future_status::ready)
            if (goOn) goOn();
    } catch (...) {
        leave(std::move(thread));
        throw;
    }
    thread.join();
    result.get();
}

}  // namespace pm::host
