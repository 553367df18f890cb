// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
//
// What ThreadSanitizer can't see of TBB: who waits for whom. TBB's library is not instrumented, so
// that what a task reads of its maker, and the maker of its tasks afterwards, would all be races.
// Each source of a build with PM_SANITIZE=thread begins with this file: the calls of TBB that pm
// makes tell the sanitizer where tasks begin and end. Two tasks of one call are in no order, as
// before, so races between them are found.
#pragma once

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/concurrent_unordered_map.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/parallel_invoke.h>
#include <oneapi/tbb/parallel_reduce.h>
#include <oneapi/tbb/task_arena.h>
#include <oneapi/tbb/task_group.h>

#include <type_traits>
#include <utility>

extern "C" {
void __tsan_acquire(void* address);
void __tsan_release(void* address);
}

namespace tbb::pm_seen {

// What came before it happens before each of its tasks; each task happens before what follows
// join(). Must outlive its tasks.
class Fork {
  public:
    Fork() { before(); }
    Fork(const Fork&) = delete;
    Fork& operator=(const Fork&) = delete;

    // Again, for what the maker of tasks has done since.
    void before() { __tsan_release(&m_begin); }
    void join() { __tsan_acquire(&m_end); }

    // f as a task; f itself must outlive it.
    template <typename F>
    auto task(const F& f) {
        return [this, &f](auto&&... arguments) -> decltype(auto) {
            const Span span(*this);
            return f(std::forward<decltype(arguments)>(arguments)...);
        };
    }
    // The same with an f of its own.
    template <typename F>
    auto ownTask(F f) {
        return [this, f = std::move(f)] {
            const Span span(*this);
            f();
        };
    }
    // As task(), for what puts results of tasks together: each sees what ended before it.
    template <typename F>
    auto reduction(const F& f) {
        return [this, &f](auto&&... arguments) -> decltype(auto) {
            join();
            const Span span(*this);
            return f(std::forward<decltype(arguments)>(arguments)...);
        };
    }

  private:
    // A task from here to the end of the block, thrown out of or not.
    class Span {
      public:
        explicit Span(Fork& fork) : m_fork(fork) { __tsan_acquire(&fork.m_begin); }
        ~Span() { __tsan_release(&m_fork.m_end); }
        Span(const Span&) = delete;
        Span& operator=(const Span&) = delete;

      private:
        Fork& m_fork;
    };

    char m_begin = 0, m_end = 0;
};

// Joins at the end of the block, thrown out of or not.
class Join {
  public:
    explicit Join(Fork& fork) : m_fork(fork) {}
    ~Join() { m_fork.join(); }
    Join(const Join&) = delete;
    Join& operator=(const Join&) = delete;

  private:
    Fork& m_fork;
};

}  // namespace tbb::pm_seen

namespace tbb {

template <typename Range, typename Body, typename... More>
requires(!std::is_integral_v<Range>) void pm_seen_parallel_for(const Range& range, const Body& body,
                                                               More&&... more) {
    pm_seen::Fork fork;
    const pm_seen::Join join(fork);
    parallel_for(range, fork.task(body), std::forward<More>(more)...);
}

template <typename Index, typename Body>
requires std::is_integral_v<Index>
void pm_seen_parallel_for(Index first, Index last, const Body& body) {
    pm_seen::Fork fork;
    const pm_seen::Join join(fork);
    parallel_for(first, last, fork.task(body));
}

template <typename... Functions>
void pm_seen_parallel_invoke(const Functions&... functions) {
    pm_seen::Fork fork;
    const pm_seen::Join join(fork);
    parallel_invoke(fork.task(functions)...);
}

template <typename Range, typename Value, typename Body, typename Reduction>
Value pm_seen_parallel_reduce(const Range& range, const Value& identity, const Body& body,
                              const Reduction& reduction) {
    pm_seen::Fork fork;
    const pm_seen::Join join(fork);
    return parallel_reduce(range, identity, fork.reduction(body), fork.reduction(reduction));
}

class pm_seen_task_group : public task_group {
  public:
    using task_group::task_group;

    template <typename F>
    void run(F f) {
        m_fork.before();
        task_group::run(m_fork.ownTask(std::move(f)));
    }
    task_group_status wait() {
        const pm_seen::Join join(m_fork);
        return task_group::wait();
    }

  private:
    pm_seen::Fork m_fork;
};

class pm_seen_task_arena : public task_arena {
  public:
    using task_arena::task_arena;

    // Another thread may do it where all places of the arena are taken.
    template <typename F>
    auto execute(const F& f) -> decltype(f()) {
        pm_seen::Fork fork;
        const pm_seen::Join join(fork);
        return task_arena::execute(fork.task(f));
    }
};

}  // namespace tbb

#define parallel_for pm_seen_parallel_for
#define parallel_invoke pm_seen_parallel_invoke
#define parallel_reduce pm_seen_parallel_reduce
#define task_group pm_seen_task_group
#define task_arena pm_seen_task_arena
