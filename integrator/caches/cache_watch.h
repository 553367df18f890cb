// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <atomic>
#include <cstdint>
#include <utility>

namespace pm {

// One look-up of a cache.
struct CacheAsked {
    std::uint32_t cache = 0;  // as CacheWatch::newCache() numbered it
    std::uint32_t key = 0;
    std::uint64_t bytes = 0;  // of the value
    bool missed = false;      // it had to be made
};

// Is told of all that the threads it watches ask caches for. Threads: each thread has a watch of
// its own or none; asked() is called on that thread.
class CacheWatch {
  public:
    virtual ~CacheWatch() = default;
    virtual void asked(const CacheAsked& what) = 0;

    // Watches the calling thread while it lives, in place of what did so before.
    class Scope {
      public:
        explicit Scope(CacheWatch* watch) : m_before(std::exchange(t_current, watch)) {}
        ~Scope() { t_current = m_before; }
        Scope(const Scope&) = delete;
        Scope& operator=(const Scope&) = delete;

      private:
        CacheWatch* m_before;
    };

    static CacheWatch* current() { return t_current; }
    // A number that no other cache of this process has.
    static std::uint32_t newCache() {
        static std::atomic<std::uint32_t> next{0};
        return next.fetch_add(1, std::memory_order_relaxed);
    }

  private:
    static inline thread_local CacheWatch* t_current = nullptr;
};

}  // namespace pm
