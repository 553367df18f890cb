// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "tests/bench/order/cache_replay.h"

#include <algorithm>
#include <memory>
#include <numeric>
#include <utility>

#include "integrator/caches/bounded_cache.h"

namespace pm::bench {

namespace {

constexpr std::uint32_t kNone = ~0u;

struct Held {
    std::uint64_t bytes;
    std::uint64_t memoryBytes() const { return bytes; }
};

// A thread's way through its buckets.
struct Walker {
    const std::vector<TracedLook>* looks = nullptr;
    std::size_t next = 0;
};

// One machine: its threads draw the next bucket of its run when they are done with theirs.
CacheReplay replayMachine(const CacheTrace& trace, std::span<const std::uint32_t> run,
                          const CacheRules& rules) {
    BoundedCache<Held> cache(std::max<std::size_t>(1, trace.bytes.size()), rules.budget);
    CacheReplay result;
    std::vector<Walker> threads(static_cast<std::size_t>(rules.threads));
    std::size_t drawn = 0;
    // By turns of some looks each: the threads are at work at the same time.
    constexpr std::size_t kTurn = 64;
    for (bool isBusy = true; isBusy;) {
        isBusy = false;
        for (Walker& thread : threads) {
            for (std::size_t i = 0; i < kTurn; ++i) {
                while ((!thread.looks || thread.next == thread.looks->size()) && drawn < run.size())
                    thread = {&trace.buckets[run[drawn++]], 0};
                if (!thread.looks || thread.next == thread.looks->size()) break;
                isBusy = true;
                const TracedLook look = (*thread.looks)[thread.next++];
                ++result.looks;
                cache.get(look.value, [&](std::size_t value) {
                    ++result.misses;
                    ++result.missesOf[look.user];
                    result.bytes += trace.bytes[value];
                    return std::make_unique<const Held>(trace.bytes[value]);
                });
            }
        }
    }
    result.mostMisses = result.misses;
    return result;
}

}  // namespace

std::uint64_t CacheTrace::workingSet() const {
    return std::accumulate(bytes.begin(), bytes.end(), std::uint64_t{0});
}

void TraceWatch::begin(std::uint32_t cell) {
    m_cell = cell;
    m_recent.fill(kNone);
}

void TraceWatch::asked(const CacheAsked& what) {
    if (what.cache == m_untraced) return;
    const std::uint64_t name = std::uint64_t{what.cache} << 48 ^ what.key;
    const auto [found, isNew] =
        m_numbers.try_emplace(name, static_cast<std::uint32_t>(m_trace.bytes.size()));
    if (isNew) m_trace.bytes.push_back(what.bytes);
    const std::uint32_t value = found->second;
    if (std::ranges::find(m_recent, value) != m_recent.end()) return;
    m_recent[m_next++ % kRecent] = value;
    m_trace.buckets[m_cell].push_back(
        {value & 0xfffffffu, static_cast<std::uint32_t>(what.user) & 0xfu});
}

CacheTrace batched(const CacheTrace& trace) {
    CacheTrace result{trace.bytes, {}};
    std::vector<std::size_t> lastBucket(trace.bytes.size(), trace.buckets.size());
    for (std::size_t bucket = 0; bucket < trace.buckets.size(); ++bucket) {
        std::vector<TracedLook>& looks = result.buckets.emplace_back();
        for (const TracedLook look : trace.buckets[bucket])
            if (std::exchange(lastBucket[look.value], bucket) != bucket) looks.push_back(look);
    }
    return result;
}

CacheTrace coarsened(const CacheTrace& trace, std::span<const CacheUser> users,
                     std::uint64_t divisor) {
    CacheTrace result = trace;
    const auto count = static_cast<std::uint32_t>(trace.bytes.size());
    for (const std::uint64_t bytes : trace.bytes) result.bytes.push_back(bytes / divisor);
    for (std::vector<TracedLook>& looks : result.buckets)
        for (TracedLook& look : looks)
            if (std::ranges::find(users, static_cast<CacheUser>(look.user)) != users.end())
                look.value = (look.value + count) & 0xfffffffu;
    return result;
}

CacheReplay& CacheReplay::operator+=(const CacheReplay& other) {
    looks += other.looks;
    misses += other.misses;
    bytes += other.bytes;
    for (std::size_t i = 0; i < kCacheUsers; ++i) missesOf[i] += other.missesOf[i];
    mostMisses = std::max(mostMisses, other.mostMisses);
    return *this;
}

CacheReplay replayCaches(const CacheTrace& trace, std::span<const std::uint32_t> order,
                         const CacheRules& rules) {
    CacheReplay sum;
    const auto machines = static_cast<std::size_t>(rules.machines);
    for (std::size_t machine = 0; machine < machines; ++machine) {
        const std::size_t begin = order.size() * machine / machines;
        const std::size_t end = order.size() * (machine + 1) / machines;
        sum += replayMachine(trace, order.subspan(begin, end - begin), rules);
    }
    return sum;
}

}  // namespace pm::bench
