// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "plugin/session/memory_ledger.h"

#include <algorithm>
#include <utility>

namespace pm::plugin {

namespace {

// Of the giver's budget, so that a cache is never emptied at once.
constexpr std::uint64_t kStepShare = 8;
// By so much one has to miss more than another before memory moves: less is chance.
constexpr std::uint64_t kClearlyMore = 2;

}  // namespace

std::uint64_t MemoryLedger::leastOf(const std::vector<LedgerCache>& caches) {
    std::uint64_t sum = 0;
    for (const LedgerCache& cache : caches) sum += cache.least;
    return sum;
}

std::uint64_t MemoryLedger::wholeOf(const std::vector<LedgerCache>& caches) {
    std::uint64_t sum = 0;
    for (const LedgerCache& cache : caches) sum += cache.whole;
    return sum;
}

MemoryLedger::MemoryLedger(std::uint64_t bytes, std::vector<LedgerCache> caches) {
    const std::uint64_t least = leastOf(caches), whole = wholeOf(caches);
    const double spare = bytes > least ? static_cast<double>(bytes - least) : 0.0;
    const double lacking = static_cast<double>(whole - least);
    const double share = lacking > 0.0 ? std::min(1.0, spare / lacking) : 0.0;
    for (LedgerCache& cache : caches) {
        const auto more = static_cast<double>(cache.whole - cache.least) * share;
        const std::uint64_t budget = cache.least + static_cast<std::uint64_t>(more);
        m_accounts.push_back({std::move(cache), 0, 0});
        give(m_accounts.back(), budget);
    }
}

void MemoryLedger::give(Account& account, std::uint64_t budget) {
    account.budget = budget;
    account.cache.setBudget(budget);
}

void MemoryLedger::balance() {
    const std::unique_lock lock(m_mutex, std::try_to_lock);
    if (!lock.owns_lock() || m_accounts.size() < 2) return;
    Account *most = nullptr, *least = nullptr;
    std::uint64_t mostMissed = 0, leastMissed = 0;
    for (Account& account : m_accounts) {
        const std::uint64_t missed = account.cache.bytesMissed();
        const std::uint64_t since = missed - account.missedBefore;
        account.missedBefore = missed;
        if (account.budget < account.cache.whole && (!most || since > mostMissed)) {
            most = &account;
            mostMissed = since;
        }
        if (account.budget > account.cache.least && (!least || since < leastMissed)) {
            least = &account;
            leastMissed = since;
        }
    }
    if (!most || !least || most == least || mostMissed <= kClearlyMore * leastMissed) return;
    const std::uint64_t step =
        std::min({least->budget / kStepShare + 1, least->budget - least->cache.least,
                  most->cache.whole - most->budget});
    // First the one that gives: never more is held than there is.
    give(*least, least->budget - step);
    give(*most, most->budget + step);
    ++m_moves;
}

std::vector<MemoryLedger::Share> MemoryLedger::shares() const {
    const std::lock_guard lock(m_mutex);
    std::vector<Share> shares;
    for (const Account& account : m_accounts)
        shares.push_back({account.cache.name, account.budget, account.cache.whole});
    return shares;
}

std::uint32_t MemoryLedger::moves() const {
    const std::lock_guard lock(m_mutex);
    return m_moves;
}

}  // namespace pm::plugin
