// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "plugin/values/forks.h"

#include <pthread.h>

#include <atomic>
#include <new>
#include <type_traits>

namespace pm::plugin {

namespace {

struct Forks {
    std::atomic<std::uint32_t> count{0};
    std::atomic<std::uint32_t> cutOffBelow{0};  // the count after the last fork amid work
    std::atomic<std::uint32_t> activities{0};
    std::mutex mutex;  // held by whoever forks
};

// Nothing of it is destroyed: a host may end, or fork, while renders run.
Forks& forks() noexcept {
    static constinit Forks all;
    static_assert(std::is_trivially_destructible_v<Forks>);
    return all;
}

void beforeFork() {
    forks().mutex.lock();
}
void inParent() {
    forks().mutex.unlock();
}
void inChild() {
    Forks& all = forks();
    const std::uint32_t count = ++all.count;
    if (all.activities.exchange(0) > 0) all.cutOffBelow = count;
    all.mutex.unlock();
}

bool registerHandlers() {
    if (pthread_atfork(beforeFork, inParent, inChild) != 0) throw std::bad_alloc();
    return true;
}

}  // namespace

void watchForks() {
    static const bool isWatching = registerHandlers();
    static_cast<void>(isWatching);
}

std::uint32_t forkCount() noexcept {
    return forks().count.load();
}

bool isCutOff(std::uint32_t madeAt) noexcept {
    return madeAt < forks().cutOffBelow.load();
}

CallError cutOffError() {
    return {CallStatus::kState,
            "it was made before this process was forked, and a render or another call was at work "
            "then; here it can only be released or destroyed"};
}

std::unique_lock<std::mutex> holdOffForks() {
    return std::unique_lock(forks().mutex);
}

Activity::Activity() noexcept : m_forks(forkCount()) {
    ++forks().activities;
}

// One that began in the parent was not counted in this process.
Activity::~Activity() {
    if (!isOfParent()) --forks().activities;
}

}  // namespace pm::plugin
