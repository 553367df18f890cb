// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>

namespace pm::host {

// Bytes that several threads share: who takes some waits until they are there. Threads: any.
class MemoryBudget {
  public:
    explicit MemoryBudget(std::uint64_t bytes) : m_total(bytes), m_left(bytes) {}

    // Bytes that are given back with this.
    class Share {
      public:
        Share(MemoryBudget& budget, std::uint64_t bytes) : m_budget(budget), m_bytes(bytes) {}
        ~Share() { m_budget.giveBack(m_bytes); }
        Share(const Share&) = delete;
        Share& operator=(const Share&) = delete;

      private:
        MemoryBudget& m_budget;
        std::uint64_t m_bytes;
    };

    std::uint64_t total() const { return m_total; }
    // bytes: at most total(). goOn: called while it waits; may throw.
    Share take(std::uint64_t bytes, const std::function<void()>& goOn) {
        constexpr std::chrono::milliseconds kBetweenLooks{20};
        std::unique_lock lock(m_mutex);
        while (m_left < bytes) {
            m_changed.wait_for(lock, kBetweenLooks);
            if (goOn) goOn();
        }
        m_left -= bytes;
        return {*this, bytes};
    }

  private:
    void giveBack(std::uint64_t bytes) {
        const std::lock_guard lock(m_mutex);
        m_left += bytes;
        m_changed.notify_all();
    }

    std::uint64_t m_total, m_left;
    std::mutex m_mutex;
    std::condition_variable m_changed;
};

}  // namespace pm::host
