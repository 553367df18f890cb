// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

namespace pm::plugin {

// Lives while this thread is inside a callback of the host's. Calls that would wait for callbacks
// to end ask it, so that they answer with a status instead of a deadlock.
class CallbackScope {
  public:
    CallbackScope() noexcept { ++depth(); }
    ~CallbackScope() { --depth(); }
    CallbackScope(const CallbackScope&) = delete;
    CallbackScope& operator=(const CallbackScope&) = delete;

    static bool active() noexcept { return depth() > 0; }

  private:
    static int& depth() noexcept {
        // Its place is there from a thread's start: else the C library would take memory for it
        // when it is first used, and end the process where there is none.
        [[gnu::tls_model("initial-exec")]] thread_local int callbacks = 0;
        return callbacks;
    }
};

}  // namespace pm::plugin
