// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/app/interrupt.h"

#include <signal.h>
#include <unistd.h>

#include <chrono>

namespace pm::host {
namespace {

// What a signal handler may touch; there is no other way for it to say anything.
volatile sig_atomic_t s_signal = 0;

void handleSignal(int number) {
    if (s_signal != 0) _exit(128 + number);
    s_signal = number;
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
