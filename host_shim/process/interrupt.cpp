// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/process/interrupt.h"

#include <signal.h>
#include <time.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cstdint>

namespace pm::host {
namespace {

// What a signal handler may touch; there is no other way for it to say anything.
volatile sig_atomic_t s_signal = 0;
std::atomic<std::int64_t> s_firstNanoseconds{0};
static_assert(std::atomic<std::int64_t>::is_always_lock_free);

std::int64_t now() {
    timespec time{};
    clock_gettime(CLOCK_MONOTONIC, &time);
    return std::int64_t{time.tv_sec} * 1'000'000'000 + time.tv_nsec;
}

// Some send a signal to a process and again to its group, such as timeout(1): that is one.
void handleSignal(int number) {
    constexpr std::int64_t kSameSignal = 100'000'000;  // nanoseconds
    std::int64_t first = 0;
    const std::int64_t time = now();
    if (s_firstNanoseconds.compare_exchange_strong(first, time)) {
        s_signal = number;
    } else if (time - first > kSameSignal) {
        _exit(128 + number);
    }
}

}  // namespace

void installInterruptHandlers() {
    struct sigaction action {};
    action.sa_handler = handleSignal;
    sigemptyset(&action.sa_mask);
    action.sa_flags = SA_RESTART;
    sigaction(SIGINT, &action, nullptr);
    sigaction(SIGTERM, &action, nullptr);
}

void ignoreBrokenPipes() {
    signal(SIGPIPE, SIG_IGN);
}

int interruptSignal() {
    return s_signal;
}

void throwIfInterrupted() {
    if (s_signal != 0) throw Interrupted(s_signal);
}

InterruptWatch::InterruptWatch(const std::function<void()>& onSignal)
    : m_thread([this, onSignal] {
          constexpr std::chrono::milliseconds kBetweenLooks{10};
          std::unique_lock lock(m_mutex);
          while (!m_ends && s_signal == 0) m_changed.wait_for(lock, kBetweenLooks);
          if (!m_ends) onSignal();
      }) {}

InterruptWatch::~InterruptWatch() {
    {
        const std::lock_guard lock(m_mutex);
        m_ends = true;
    }
    m_changed.notify_all();
    m_thread.join();
}

}  // namespace pm::host
