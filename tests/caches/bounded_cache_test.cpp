// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/caches/bounded_cache.h"

#include <gtest/gtest.h>

#include <atomic>
#include <barrier>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <thread>
#include <vector>

namespace pm {
namespace {

// A value that knows its key, and counts how many of its kind there are.
struct Counted {
    static inline std::atomic<int> alive{0};
    std::size_t key;
    std::uint64_t bytes;
    Counted(std::size_t k, std::uint64_t b) : key(k), bytes(b) { ++alive; }
    ~Counted() {
        key = ~std::size_t{0};
        --alive;
    }
    Counted(const Counted&) = delete;
    Counted& operator=(const Counted&) = delete;
    std::uint64_t memoryBytes() const { return bytes; }
};

std::unique_ptr<const Counted> make(std::size_t key) {
    return std::make_unique<const Counted>(key, 100);
}

TEST(BoundedCache, HoldsNoMoreThanItsBudget) {
    BoundedCache<Counted> cache(64, 1000);
    for (int round = 0; round < 2; ++round)
        for (std::size_t key = 0; key < 64; ++key) EXPECT_EQ(cache.get(key, make)->key, key);
    const CacheCounts counts = cache.counts();
    EXPECT_LE(counts.bytesHeld, 1000u);
    EXPECT_LE(counts.mostBytesHeld, 1100u);  // and the newest one
    EXPECT_EQ(Counted::alive, static_cast<int>(counts.bytesHeld / 100));
    EXPECT_EQ(counts.misses, 128u);
    EXPECT_EQ(counts.madeAgain, 64u);
    EXPECT_EQ(counts.bytesMade, 12800u);
}

TEST(BoundedCache, WhatFitsIsMadeOnce) {
    BoundedCache<Counted> cache(10, 1000);
    for (int round = 0; round < 5; ++round)
        for (std::size_t key = 0; key < 10; ++key) cache.get(key, make);
    EXPECT_EQ(cache.counts().misses, 10u);
    EXPECT_EQ(cache.counts().madeAgain, 0u);
}

TEST(BoundedCache, WhatIsUsedOutlivesWhatIsNot) {
    BoundedCache<Counted> cache(100, 1000);
    for (std::size_t key = 1; key < 100; ++key) {
        cache.get(0, make);
        cache.get(key, make);
    }
    EXPECT_EQ(cache.counts().madeAgain, 0u) << "the one that is used all the time was evicted";
}

TEST(BoundedCache, PinnedValuesStay) {
    BoundedCache<Counted> cache(64, 300);
    std::vector<BoundedCache<Counted>::Pin> pins;
    for (std::size_t key = 0; key < 10; ++key) pins.push_back(cache.get(key, make));
    for (std::size_t key = 10; key < 64; ++key) cache.get(key, make);
    for (std::size_t key = 0; key < 10; ++key) EXPECT_EQ(pins[key]->key, key);
    EXPECT_EQ(cache.counts().madeAgain, 0u);
    pins.clear();
    cache.setBudget(200);
    EXPECT_LE(cache.counts().bytesHeld, 200u);
    EXPECT_EQ(Counted::alive, static_cast<int>(cache.counts().bytesHeld / 100));
}

TEST(BoundedCache, WhatCouldNotBeMadeIsTriedAgain) {
    BoundedCache<Counted> cache(4, 1000);
    const auto fail = [](std::size_t) -> std::unique_ptr<const Counted> {
        throw std::runtime_error("no");
    };
    EXPECT_THROW(cache.get(2, fail), std::runtime_error);
    EXPECT_EQ(cache.get(2, make)->key, 2u);
    EXPECT_EQ(cache.counts().misses, 1u);
}

TEST(BoundedCache, ThreadsThatAskTogetherHaveOneValue) {
    constexpr int kThreads = 8;
    BoundedCache<Counted> cache(1, 1000);
    std::barrier start(kThreads);
    std::atomic<int> made{0};
    std::vector<std::jthread> threads;
    for (int i = 0; i < kThreads; ++i)
        threads.emplace_back([&] {
            start.arrive_and_wait();
            const auto pin = cache.get(0, [&](std::size_t key) {
                ++made;
                std::this_thread::yield();
                return make(key);
            });
            EXPECT_EQ(pin->key, 0u);
        });
    threads.clear();
    EXPECT_EQ(made, 1);
}

TEST(BoundedCache, WatchesAreToldOfTheirOwnThread) {
    struct Watch : CacheWatch {
        std::vector<CacheAsked> all;
        void asked(const CacheAsked& what) override { all.push_back(what); }
    } watch;
    BoundedCache<Counted> cache(8, 1000);
    cache.get(1, make);
    {
        const CacheWatch::Scope scope(&watch);
        cache.get(1, make);
        {
            const CacheWatch::As as(CacheUser::kGather);
            cache.get(2, make);
        }
        EXPECT_EQ(CacheWatch::user(), CacheUser::kCamera);
        std::jthread([&] { cache.get(3, make); });
    }
    cache.get(4, make);
    ASSERT_EQ(watch.all.size(), 2u);
    EXPECT_EQ(watch.all[0].key, 1u);
    EXPECT_FALSE(watch.all[0].missed);
    EXPECT_EQ(watch.all[1].key, 2u);
    EXPECT_TRUE(watch.all[1].missed);
    EXPECT_EQ(watch.all[1].user, CacheUser::kGather);
    EXPECT_EQ(watch.all[1].bytes, 100u);
    EXPECT_EQ(watch.all[1].cache, cache.number());
    EXPECT_TRUE(cache.holds(4));
    EXPECT_FALSE(cache.holds(5));
}

// Each thread goes its own way over all keys, with two values pinned at a time.
TEST(BoundedCache, ThrashingThreadsFindTheirValues) {
    constexpr std::size_t kKeys = 61, kThreads = 6;
    {
        BoundedCache<Counted> cache(kKeys, 500);
        std::vector<std::jthread> threads;
        for (std::size_t t = 0; t < kThreads; ++t)
            threads.emplace_back([&, t] {
                BoundedCache<Counted>::Pin last;
                std::size_t lastKey = 0;
                for (std::size_t i = 0; i < 20000; ++i) {
                    const std::size_t key = (i * (t + 1) + (i / 97) * t) % kKeys;
                    auto pin = cache.get(key, make);
                    ASSERT_EQ(pin->key, key);
                    if (last) {
                        ASSERT_EQ(last->key, lastKey);
                    }
                    last = std::move(pin);
                    lastKey = key;
                }
            });
        threads.clear();
        const CacheCounts counts = cache.counts();
        EXPECT_GT(counts.madeAgain, 1000u);
        EXPECT_LE(counts.mostBytesHeld, 500u + 100u * 3 * kThreads);
        EXPECT_EQ(Counted::alive, static_cast<int>(counts.bytesHeld / 100));
    }
    EXPECT_EQ(Counted::alive, 0);
}

}  // namespace
}  // namespace pm
