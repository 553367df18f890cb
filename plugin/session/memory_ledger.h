// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>
#include <functional>
#include <mutex>
#include <string>
#include <vector>

namespace pm::plugin {

// A cache as the ledger sees it.
struct LedgerCache {
    std::string name;
    std::uint64_t least = 0;  // bytes without which it can't work
    std::uint64_t whole = 0;  // of all that it could ever hold; at least `least`
    std::function<void(std::uint64_t bytes)> setBudget;
    std::function<std::uint64_t()> bytesMissed;  // read or made so far, rising
};

// Divides memory among caches that make again what they had to forget, and moves it to who misses
// most. No picture depends on it. Threads: all functions from any, at once.
class MemoryLedger {
  public:
    // Gives each cache its least and shares the rest in proportion to what they lack. bytes: for
    // all; at least leastOf(caches), else that much is given all the same.
    MemoryLedger(std::uint64_t bytes, std::vector<LedgerCache> caches);

    static std::uint64_t leastOf(const std::vector<LedgerCache>& caches);
    static std::uint64_t wholeOf(const std::vector<LedgerCache>& caches);

    // Moves a step from the cache that missed least since the last call to the one that missed
    // most, where that is clearly more. Returns at once while another thread is at it.
    void balance();

    struct Share {
        std::string name;
        std::uint64_t budget = 0, whole = 0;
    };
    std::vector<Share> shares() const;
    std::uint32_t moves() const;

  private:
    struct Account {
        LedgerCache cache;
        std::uint64_t budget = 0, missedBefore = 0;
    };
    void give(Account& account, std::uint64_t budget);

    mutable std::mutex m_mutex;
    std::vector<Account> m_accounts;
    std::uint32_t m_moves = 0;
};

}  // namespace pm::plugin
