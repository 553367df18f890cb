// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Checkpoints that were torn or damaged: the same bits, or a refusal that names the file. Never
// another picture, never a crash.
#include <random>

#include "tests/pieces/piece_host.h"

namespace pm::test {

namespace {

class Damage : public PieceHost {
  protected:
    void SetUp() override {
        PieceHost::SetUp();
        m_settings["passes"] = "7";
        m_whole = render({});
        // Cancelled in its last pass: sums, then records.
        render({{"checkpoint", path("c")}}, 6 * 20 + 10);
        m_bytes = readFile(path("c"));
        m_sums = m_bytes.find("\"passes\":") + 9;
        ASSERT_NE('0', m_bytes.at(m_sums)) << "the checkpoint has no sums";
    }
    Outcome resume() { return render({{"checkpoint", path("c")}, {"resume", "1"}}); }

    Outcome m_whole;
    std::string m_bytes;
    std::size_t m_sums = 0;
};

TEST_F(Damage, ATornLastRecordIsDroppedWithAMessage) {
    for (const std::size_t lost : {std::size_t{1}, std::size_t{20}, std::size_t{4000}}) {
        writeFile(path("c"), m_bytes.substr(0, m_bytes.size() - lost));
        const Outcome resumed = resume();
        expectSameBits(m_whole, resumed);
        EXPECT_NE(std::string::npos, resumed.warnings.find("torn")) << resumed.warnings;
    }
    writeFile(path("c"), m_bytes);
    EXPECT_EQ("", resume().warnings);
}

TEST_F(Damage, WhatAPowerCutMayLeaveBehindIsDropped) {
    // Blocks that were not written yet, and remains of another file.
    for (const std::string& end : {std::string(5000, '\0'), std::string(777, 'x'), m_bytes}) {
        writeFile(path("c"), m_bytes + end);
        const Outcome resumed = resume();
        expectSameBits(m_whole, resumed);
        EXPECT_NE("", resumed.warnings);
    }
}

TEST_F(Damage, WhatFollowsADamagedRecordIsGoneForGood) {
    // Records are of the same size: what is rendered in place of the damaged one would be
    // followed by whole ones, of buckets that may be rendered twice then.
    std::string bytes = m_bytes;
    bytes[bytes.size() - 9 * 6000] ^= 1;
    writeFile(path("c"), bytes);
    render({{"checkpoint", path("c")}, {"resume", "1"}, {"bucketOrder", "spiral"}}, 21);
    const std::string after = readFile(path("c"));
    // More than a record: which bucket is the last one before a cancel is a matter of time.
    EXPECT_FALSE(after.ends_with(m_bytes.substr(m_bytes.size() - 4 * 6000)));
    expectSameBits(m_whole, resume());
}

TEST_F(Damage, CutAnywhere) {
    std::mt19937 random(1);
    int resumedOnes = 0;
    for (int i = 0; i < 12; ++i) {
        const std::size_t among = i % 2 == 0 ? m_bytes.size() : 8000;
        writeFile(path("c"), m_bytes.substr(0, m_bytes.size() - 1 - random() % among));
        const Outcome resumed = resume();
        if (resumed.isOk()) {
            expectSameBits(m_whole, resumed);
            ++resumedOnes;
            continue;
        }
        EXPECT_EQ(PMR_ERROR_FILE, resumed.started == PMR_OK ? resumed.ended : resumed.started);
        EXPECT_NE(std::string::npos, resumed.error.find(path("c"))) << resumed.error;
    }
    EXPECT_GT(resumedOnes, 0);
}

TEST_F(Damage, AFlippedByteAnywhere) {
    std::mt19937 random(2);
    int refused = 0, resumedOnes = 0;
    for (int i = 0; i < 16; ++i) {
        std::string bytes = m_bytes;
        // Every other one in the last record or two, which are dropped; most bytes are sums.
        const std::size_t among = i % 2 == 0 ? bytes.size() : 8000;
        bytes[bytes.size() - 1 - random() % among] ^= static_cast<char>(1u << (random() % 8));
        writeFile(path("c"), bytes);
        const Outcome resumed = resume();
        if (resumed.isOk()) {
            expectSameBits(m_whole, resumed);
            ++resumedOnes;
            continue;
        }
        ++refused;
        EXPECT_EQ(PMR_ERROR_FILE, resumed.started == PMR_OK ? resumed.ended : resumed.started);
        EXPECT_NE(std::string::npos, resumed.error.find(path("c"))) << resumed.error;
    }
    EXPECT_GT(refused, 0);
    EXPECT_GT(resumedOnes, 0);
}

TEST_F(Damage, AHeadThatCanNotBeUnderstoodIsRefused) {
    std::string bytes = m_bytes;
    bytes[40] ^= 1;
    writeFile(path("c"), bytes);
    const Outcome resumed = resume();
    EXPECT_EQ(PMR_ERROR_FILE, resumed.started);
    EXPECT_NE(std::string::npos, resumed.error.find("its head is broken")) << resumed.error;
}

}  // namespace

}  // namespace pm::test
