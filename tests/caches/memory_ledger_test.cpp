// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "plugin/session/memory_ledger.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

namespace pm::plugin {
namespace {

constexpr std::uint64_t kMib = 1 << 20;

// A cache that misses what its budget leaves out of its working set, once a round.
struct Simulated {
    std::uint64_t least, whole, workingSet;
    std::uint64_t budget = 0, missed = 0;

    LedgerCache cache(const char* name) {
        return {name, least, whole, [this](std::uint64_t bytes) { budget = bytes; },
                [this] { return missed; }};
    }
    void round() { missed += workingSet > budget ? workingSet - budget : 0; }
};

TEST(MemoryLedger, SharesByWhatCachesLack) {
    Simulated a{10 * kMib, 110 * kMib, 0}, b{0, 300 * kMib, 0};
    const MemoryLedger ledger(210 * kMib, {a.cache("a"), b.cache("b")});
    EXPECT_EQ(a.budget, 60 * kMib);
    EXPECT_EQ(b.budget, 150 * kMib);
}

TEST(MemoryLedger, GivesNoMoreThanTheyCouldHold) {
    Simulated a{0, 10 * kMib, 0}, b{0, 20 * kMib, 0};
    const MemoryLedger ledger(1000 * kMib, {a.cache("a"), b.cache("b")});
    EXPECT_EQ(a.budget, 10 * kMib);
    EXPECT_EQ(b.budget, 20 * kMib);
}

TEST(MemoryLedger, MovesMemoryToWhoMissesMost) {
    Simulated idle{8 * kMib, 400 * kMib, 0}, busy{8 * kMib, 400 * kMib, 300 * kMib};
    MemoryLedger ledger(216 * kMib, {idle.cache("idle"), busy.cache("busy")});
    const std::uint64_t before = busy.budget;
    for (int i = 0; i < 100; ++i) {
        busy.round();
        ledger.balance();
        EXPECT_LE(idle.budget + busy.budget, 216 * kMib);
        EXPECT_GE(idle.budget, idle.least);
    }
    EXPECT_GT(busy.budget, before + 60 * kMib);
    EXPECT_LT(idle.budget, 20 * kMib);
    EXPECT_GT(ledger.moves(), 4u);
}

TEST(MemoryLedger, RestsWhereBothMissAlike) {
    Simulated a{0, 400 * kMib, 300 * kMib}, b{0, 400 * kMib, 290 * kMib};
    MemoryLedger ledger(200 * kMib, {a.cache("a"), b.cache("b")});
    for (int i = 0; i < 20; ++i) {
        a.round();
        b.round();
        ledger.balance();
    }
    EXPECT_EQ(ledger.moves(), 0u);
}

TEST(MemoryLedger, ReturnsToWhoNeedsItLater) {
    Simulated a{0, 400 * kMib, 0}, b{0, 400 * kMib, 300 * kMib};
    MemoryLedger ledger(200 * kMib, {a.cache("a"), b.cache("b")});
    const auto rounds = [&] {
        for (int i = 0; i < 100; ++i) {
            a.round();
            b.round();
            ledger.balance();
        }
    };
    rounds();
    EXPECT_GT(b.budget, 180 * kMib);
    a.workingSet = 300 * kMib;
    b.workingSet = 0;
    rounds();
    EXPECT_GT(a.budget, 180 * kMib);
}

}  // namespace
}  // namespace pm::plugin
