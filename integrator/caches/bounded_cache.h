// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "integrator/caches/cache_watch.h"

namespace pm {

// What a cache had to do so far.
struct CacheCounts {
    std::uint64_t misses = 0;     // values that were made
    std::uint64_t madeAgain = 0;  // of these, such as had been made before and were evicted
    std::uint64_t waits = 0;      // look-ups that waited for another thread's making
    std::uint64_t bytesMade = 0;
    std::uint64_t bytesHeld = 0;  // now
    std::uint64_t mostBytesHeld = 0;
    std::array<std::uint64_t, kCacheUsers> missesOf{};  // by CacheUser
};

// Values of a known number of keys, made when they are first asked for and evicted by use (CLOCK,
// Corbato 1968) while more bytes are held than the budget; what is pinned stays. A value is to be a
// function of its key, so that a cache of any size gives the same bits. Nobody waits but for a
// value that another thread is making at that time: there is no lock for all, and none at all for
// what is there. A value is never made by two threads at once.
// Value: has memoryBytes(), a constant. Threads: all functions from any, at once; a thread may pin
// several values, but must not make one inside of make().
template <typename Value>
class BoundedCache {
    struct Slot;

  public:
    // budget: bytes.
    BoundedCache(std::size_t keys, std::uint64_t budget) : m_slots(keys), m_budget(budget) {}
    BoundedCache(const BoundedCache&) = delete;
    BoundedCache& operator=(const BoundedCache&) = delete;

    // Keeps a value where it is. Moved or destroyed by the thread that got it, or another.
    class Pin {
      public:
        Pin() = default;
        Pin(Pin&& other) noexcept : m_slot(std::exchange(other.m_slot, nullptr)) {}
        Pin& operator=(Pin&& other) noexcept {
            if (this != &other) {
                release();
                m_slot = std::exchange(other.m_slot, nullptr);
            }
            return *this;
        }
        ~Pin() { release(); }
        explicit operator bool() const { return m_slot != nullptr; }
        const Value& operator*() const { return *m_slot->value; }
        const Value* operator->() const { return m_slot->value.get(); }

      private:
        friend class BoundedCache;
        explicit Pin(Slot* slot) : m_slot(slot) {}
        void release() {
            if (m_slot) m_slot->state.fetch_sub(1, std::memory_order_release);
            m_slot = nullptr;
        }
        Slot* m_slot = nullptr;
    };

    // The value of a key below the number of keys; make(key) gives a std::unique_ptr<Value> where
    // it is not there. What make throws goes on to the caller; the next one tries again.
    template <typename Make>
    Pin get(std::size_t key, Make&& make) {
        Slot& slot = m_slots[key];
        const std::uint32_t state = slot.state.fetch_add(1, std::memory_order_acquire);
        // Only a second use counts: a scan of many values evicts itself first.
        const bool missed = !(state & kReady) && claim(slot);
        if (missed)
            fill(slot, key, make);
        else if (!slot.used.load(std::memory_order_relaxed))
            slot.used.store(true, std::memory_order_relaxed);
        if (CacheWatch* const watch = CacheWatch::current())
            watch->asked({m_number, key, slot.value->memoryBytes(), missed, CacheWatch::user()});
        return Pin(&slot);
    }

    // Whether its value is there now, and so would be no miss.
    bool holds(std::size_t key) const {
        return (m_slots[key].state.load(std::memory_order_relaxed) & kReady) != 0;
    }
    // As CacheWatch knows it.
    std::uint32_t number() const { return m_number; }

    std::uint64_t budget() const { return m_budget.load(std::memory_order_relaxed); }
    // Evicts at once where it is less than what is held.
    void setBudget(std::uint64_t bytes) {
        m_budget.store(bytes, std::memory_order_relaxed);
        evict();
    }

    CacheCounts counts() const {
        CacheCounts counts{m_misses.load(),    m_madeAgain.load(), m_waits.load(),
                           m_bytesMade.load(), m_bytesHeld.load(), m_mostBytesHeld.load()};
        for (std::size_t i = 0; i < kCacheUsers; ++i) counts.missesOf[i] = m_missesOf[i].load();
        return counts;
    }
    // Of the cache itself, without its values.
    static std::uint64_t bytesFor(std::size_t keys) { return keys * sizeof(Slot); }

  private:
    static constexpr std::uint32_t kReady = 1u << 31, kMaking = 1u << 30;

    struct Slot {
        std::atomic<std::uint32_t> state{0};  // kReady or kMaking, and how many pin it
        std::atomic<bool> used{false};        // since it was made or the clock's hand was here
        bool wasMade = false;                 // written while kMaking
        std::unique_ptr<const Value> value;   // while kReady
    };

    // Of a slot that this thread pins. True: this thread is to make its value; false: it is there.
    bool claim(Slot& slot) {
        bool hasWaited = false;
        for (;;) {
            std::uint32_t state = slot.state.load(std::memory_order_acquire);
            if (state & kReady) return false;
            if (state & kMaking) {
                if (!std::exchange(hasWaited, true))
                    m_waits.fetch_add(1, std::memory_order_relaxed);
                slot.state.wait(state, std::memory_order_acquire);
                continue;
            }
            if (slot.state.compare_exchange_weak(state, state | kMaking, std::memory_order_acquire))
                return true;
        }
    }

    // Of a slot that this thread pins and has claimed.
    template <typename Make>
    void fill(Slot& slot, std::size_t key, Make& make) {
        try {
            slot.value = make(key);
        } catch (...) {
            slot.state.fetch_sub(kMaking + 1, std::memory_order_release);
            slot.state.notify_all();
            throw;
        }
        const std::uint64_t bytes = slot.value->memoryBytes();
        m_misses.fetch_add(1, std::memory_order_relaxed);
        m_missesOf[static_cast<std::size_t>(CacheWatch::user())].fetch_add(
            1, std::memory_order_relaxed);
        if (std::exchange(slot.wasMade, true)) m_madeAgain.fetch_add(1, std::memory_order_relaxed);
        m_bytesMade.fetch_add(bytes, std::memory_order_relaxed);
        const std::uint64_t held = m_bytesHeld.fetch_add(bytes, std::memory_order_relaxed) + bytes;
        std::uint64_t most = m_mostBytesHeld.load(std::memory_order_relaxed);
        while (most < held && !m_mostBytesHeld.compare_exchange_weak(most, held)) {
        }
        slot.state.fetch_add(kReady - kMaking, std::memory_order_release);
        slot.state.notify_all();
        evict();
    }

    // Until no more is held than the budget, or two rounds of the hand have found nothing to evict.
    void evict() {
        for (std::size_t step = 0; step < 2 * m_slots.size() + 2; ++step) {
            if (m_bytesHeld.load(std::memory_order_relaxed) <= budget()) return;
            Slot& slot = m_slots[m_hand.fetch_add(1, std::memory_order_relaxed) % m_slots.size()];
            std::uint32_t state = slot.state.load(std::memory_order_relaxed);
            if (state != kReady) continue;
            if (slot.used.exchange(false, std::memory_order_relaxed)) continue;
            // Nobody gets in while it is being made.
            if (!slot.state.compare_exchange_strong(state, kMaking, std::memory_order_acquire))
                continue;
            m_bytesHeld.fetch_sub(slot.value->memoryBytes(), std::memory_order_relaxed);
            slot.value.reset();
            slot.state.fetch_sub(kMaking, std::memory_order_release);
            slot.state.notify_all();
        }
    }

    const std::uint32_t m_number = CacheWatch::newCache();
    std::vector<Slot> m_slots;
    std::atomic<std::uint64_t> m_budget;
    std::atomic<std::size_t> m_hand{0};
    std::atomic<std::uint64_t> m_misses{0}, m_madeAgain{0}, m_waits{0}, m_bytesMade{0},
        m_bytesHeld{0}, m_mostBytesHeld{0};
    std::array<std::atomic<std::uint64_t>, kCacheUsers> m_missesOf{};
};

}  // namespace pm
