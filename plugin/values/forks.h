// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// A child that a host forks has one thread: none of the library's, and whatever lock another thread
// held stays locked in it. So it must know what was at work when it was forked.
#pragma once

#include <cstdint>
#include <mutex>
#include <utility>

#include "plugin/values/call_error.h"

namespace pm::plugin {

// Begins to notice forks: before the first Activity. Errors: std::bad_alloc. Threads: any.
void watchForks();

// How many forks lie between this process and the one that loaded the library. Threads: any.
std::uint32_t forkCount() noexcept;

// Whether what was made at that fork count may be in the middle of a change by a thread that this
// process hasn't got: one was at work at a fork since. Threads: any.
bool isCutOff(std::uint32_t madeAt) noexcept;

// Why a call on such a thing fails.
CallError cutOffError();

// Held while no fork may come between two steps. Nothing that may wait is done under it.
[[nodiscard]] std::unique_lock<std::mutex> holdOffForks();

// Lives while a thread is in a call or works for a render. Threads: any.
class Activity {
  public:
    Activity() noexcept;
    ~Activity();
    Activity(const Activity&) = delete;
    Activity& operator=(const Activity&) = delete;

    // Since this began the process has become a child of that in which it did.
    bool isOfParent() const noexcept { return m_forks != forkCount(); }

  private:
    const std::uint32_t m_forks;
};

}  // namespace pm::plugin
