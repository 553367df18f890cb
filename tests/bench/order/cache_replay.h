// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// What caches of any size would miss, in any order of buckets and on any number of machines: a
// replay of what each bucket asked for when it was rendered once.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
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
    // untraced: a cache that it does not write down.
    explicit TraceWatch(std::size_t cells, std::optional<std::uint32_t> untraced = {})
        : m_untraced(untraced) {
        m_trace.buckets.resize(cells);
    }
    // What is asked from here on is this bucket's.
    void begin(std::uint32_t cell);
    void asked(const CacheAsked& what) override;
    CacheTrace take() { return std::move(m_trace); }

  private:
    // A cache of so few values is none.
    static constexpr std::size_t kRecent = 16;
    std::optional<std::uint32_t> m_untraced;
    CacheTrace m_trace;
    std::unordered_map<std::uint64_t, std::uint32_t> m_numbers;
    std::array<std::uint32_t, kRecent> m_recent{};
    std::size_t m_next = 0;
    std::uint32_t m_cell = 0;
};

// As if each bucket asked for each value once, for all of its rays that need it: the most that
// sorting or batching its rays can win.
CacheTrace batched(const CacheTrace& trace);

// As if these users asked for values of their own, `divisor` times smaller, in place of the
// others': rays that see coarser groups of triangles.
CacheTrace coarsened(const CacheTrace& trace, std::span<const CacheUser> users,
                     std::uint64_t divisor);

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
