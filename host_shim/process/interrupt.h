// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>
#include <stdexcept>
#include <thread>

namespace pm::host {

// Installs handlers for SIGINT and SIGTERM: the first is noted, a second ends the process at once
// with 128 + signal; within 0.1 s it counts as the first. Only main calls this.
void installInterruptHandlers();

// Who reads what this process prints may go away before the picture is finished: then printing
// fails, and the process lives. For the whole process.
void ignoreBrokenPipes();

// The signal that came, 0 when none did.
int interruptSignal();

// Thrown between the steps of the work when a signal has come.
struct Interrupted : std::runtime_error {
    explicit Interrupted(int signal)
        : std::runtime_error(signal == 2 ? "interrupted" : "terminated"), exitCode(128 + signal) {}
    int exitCode;
};
void throwIfInterrupted();

// Calls onSignal once, from a thread of its own, soon after a signal has come; for work that this
// thread can't look up from. A signal that came before counts.
class InterruptWatch {
  public:
    explicit InterruptWatch(const std::function<void()>& onSignal);
    ~InterruptWatch();
    InterruptWatch(const InterruptWatch&) = delete;
    InterruptWatch& operator=(const InterruptWatch&) = delete;

  private:
    std::mutex m_mutex;
    std::condition_variable m_changed;
    bool m_ends = false;
    std::thread m_thread;
};

}  // namespace pm::host
