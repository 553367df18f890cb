// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// What caches of any size would miss, in any order of buckets and on any number of machines: a
// replay of what each bucket asked for when it was rendered once.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "integrator/caches/cache_watch.h"

namespace pm::bench {

// A value that was asked for, and by whom.
struct TracedLook {
    std::uint32_t value : 28;  // in CacheTrace::bytes
    std::uint32_t user : 4;    // a CacheUser
};

// What buckets ask for. Values of all caches are numbered as they come; each bucket's looks in
// their order, without those that repeat one of the last few.
struct CacheTrace {
    std::vector<std::uint64_t> bytes;              // of each value
    std::vector<std::vector<TracedLook>> buckets;  // by cell
    std::uint64_t workingSet() const;              // bytes of all values
};

// Writes one. Threads: one.
class TraceWatch : public CacheWatch {
  public:
    explicit TraceWatch(std::size_t cells) { m_trace.buckets.resize(cells); }
    // What is asked from here on is this bucket's.
    void begin(std::uint32_t cell);
    void asked(const CacheAsked& what) override;
    CacheTrace take() { return std::move(m_trace); }

  private:
    // A cache of so few values is none.
    static constexpr std::size_t kRecent = 16;
    CacheTrace m_trace;
    std::unordered_map<std::uint64_t, std::uint32_t> m_numbers;
    std::array<std::uint32_t, kRecent> m_recent{};
    std::size_t m_next = 0;
    std::uint32_t m_cell = 0;
};

struct CacheRules {
    std::uint64_t budget = 0;  // bytes, of each machine
    int threads = 1;           // of each machine, which share its cache and take looks by turns
    int machines = 1;          // each with one of as many runs of the order
};

struct CacheReplay {
    std::uint64_t looks = 0, misses = 0, bytes = 0;  // of all machines
    std::array<std::uint64_t, kCacheUsers> missesOf{};
    std::uint64_t mostMisses = 0;  // of one machine
    CacheReplay& operator+=(const CacheReplay& other);
};

// order: cells. The caches are those of the renderer, BoundedCache; empty when they begin.
CacheReplay replayCaches(const CacheTrace& trace, std::span<const std::uint32_t> order,
                         const CacheRules& rules);

}  // namespace pm::bench
