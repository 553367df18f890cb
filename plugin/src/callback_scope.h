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
        thread_local int callbacks = 0;
        return callbacks;
    }
};

}  // namespace pm::plugin
