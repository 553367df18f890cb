// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "plugin/session/leave_behind.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdlib>
#include <exception>
#include <mutex>
#include <new>
#include <thread>
#include <vector>

#include "integrator/values/error.h"
#include "plugin/values/forks.h"
#include "scheduler/buckets/fp_environment.h"

namespace pm::plugin {

namespace {

constexpr std::chrono::milliseconds kBetweenLooks{5};
// For work that looks at its check: its own end is tidier.
constexpr std::chrono::milliseconds kGrace{60};

struct Job {
    std::atomic<bool> cancelled{false};
    std::mutex mutex;
    std::condition_variable ended;
    bool isOver = false;
    std::exception_ptr failure;

    void run(std::function<void(const CancelCheck&)> work) {
        const FpEnvironment environment;
        const Activity activity;
        std::exception_ptr thrown;
        try {
            work(CancelCheck(cancelled));
        } catch (...) {
            thrown = std::current_exception();
        }
        work = nullptr;
        const std::lock_guard lock(mutex);
        failure = std::move(thrown);
        isOver = true;
        ended.notify_all();
    }
    bool waitFor(std::chrono::milliseconds time) {
        std::unique_lock lock(mutex);
        return ended.wait_for(lock, time, [this] { return isOver; });
    }
    // Whether it has ended when `cancel` is set or it ends, which comes first.
    bool waitUntilOver(const CancelCheck& cancel) {
        while (!cancel.isSet())
            if (waitFor(kBetweenLooks)) return true;
        return false;
    }
};

struct LeftThread {
    std::shared_ptr<Job> job;
    std::thread thread;
};

// Those left behind, of the whole process.
class LeftThreads {
  public:
    // A child that was forked has none of them, and nobody who would unlock the mutex.
    const std::uint32_t forkCount = plugin::forkCount();

    // Takes nothing where it throws.
    void add(const std::shared_ptr<Job>& job, std::thread& thread) {
        const std::lock_guard lock(m_mutex);
        m_threads.emplace_back();
        m_threads.back() = {job, std::move(thread)};
    }
    void joinEnded() {
        const std::lock_guard lock(m_mutex);
        std::erase_if(m_threads, [](LeftThread& left) {
            if (!left.job->waitFor(std::chrono::milliseconds{0})) return false;
            left.thread.join();
            return true;
        });
    }
    void joinAll() {
        const std::lock_guard lock(m_mutex);
        for (LeftThread& left : m_threads) left.thread.join();
        m_threads.clear();
    }
    std::shared_ptr<Job> first() const {
        const std::lock_guard lock(m_mutex);
        return m_threads.empty() ? nullptr : m_threads.front().job;
    }

  private:
    mutable std::mutex m_mutex;
    std::vector<LeftThread> m_threads;
};

// Never destroyed: threads may end after static objects do.
LeftThreads& leftThreads() {
    static std::atomic<LeftThreads*> current{nullptr};
    LeftThreads* known = current.load();
    if (known != nullptr && known->forkCount == forkCount()) return *known;
    auto made = std::make_unique<LeftThreads>();
    return current.compare_exchange_strong(known, made.get()) ? *made.release() : *known;
}

// Registered as late as possible: what libraries have made until now is destroyed after this.
void joinAtExit() {
    std::atexit([] { leftThreads().joinAll(); });
}

// Without memory to leave it, it is waited for.
void leaveBehind(const std::shared_ptr<Job>& job, std::thread& thread) {
    try {
        joinAtExit();
        leftThreads().add(job, thread);
    } catch (const std::bad_alloc&) {
        thread.join();
    }
}

void waitForThoseLeft(const CancelCheck& cancel, const char* what) {
    for (leftThreads().joinEnded(); const auto job = leftThreads().first();
         leftThreads().joinEnded())
        if (!job->waitUntilOver(cancel)) cancel.throwIfSet(what);
}

}  // namespace

void callLeavable(const CancelCheck& cancel, const char* what,
                  std::function<void(const CancelCheck&)> work) {
    cancel.throwIfSet(what);
    waitForThoseLeft(cancel, what);
    const auto job = std::make_shared<Job>();
    std::thread thread([job, work = std::move(work)]() mutable { job->run(std::move(work)); });
    if (!job->waitUntilOver(cancel)) {
        job->cancelled = true;
        if (!job->waitFor(kGrace)) {
            leaveBehind(job, thread);
            throw Error(Status::kCancelled, std::string("cancelled while ") + what);
        }
    }
    thread.join();
    if (job->failure) std::rethrow_exception(job->failure);
}

}  // namespace pm::plugin
