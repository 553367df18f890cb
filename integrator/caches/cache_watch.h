// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <utility>

namespace pm {

// What a thread is at while it asks: what the camera sees, light of lamps, paths that go on from
// there, rays that gather indirect light, photons.
enum class CacheUser : std::uint8_t { kCamera, kShadow, kBounce, kGather, kPhoton };
inline constexpr std::size_t kCacheUsers = 5;
inline constexpr const char* kCacheUserNames[kCacheUsers] = {"camera", "shadow", "bounce", "gather",
                                                             "photon"};

// One look-up of a cache.
struct CacheAsked {
    std::uint32_t cache = 0;  // as CacheWatch::newCache() numbered it
    std::uint64_t key = 0;
    std::uint64_t bytes = 0;  // of the value
    bool missed = false;      // it had to be made
    CacheUser user = CacheUser::kCamera;
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

    // What the calling thread is at while it lives.
    class As {
      public:
        explicit As(CacheUser user) : m_before(std::exchange(t_user, user)) {}
        ~As() { t_user = m_before; }
        As(const As&) = delete;
        As& operator=(const As&) = delete;

      private:
        CacheUser m_before;
    };

    static CacheWatch* current() { return t_current; }
    static CacheUser user() { return t_user; }
    // A number that no other cache of this process has.
    static std::uint32_t newCache() {
        static std::atomic<std::uint32_t> next{0};
        return next.fetch_add(1, std::memory_order_relaxed);
    }

  private:
    static inline thread_local CacheWatch* t_current = nullptr;
    static inline thread_local CacheUser t_user = CacheUser::kCamera;
};

}  // namespace pm
