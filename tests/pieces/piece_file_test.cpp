// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "plugin/storage/piece_file.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

namespace pm::plugin::test {

namespace {

class PieceFile : public ::testing::Test {
  protected:
    void SetUp() override {
        m_name = ::testing::TempDir() + "pm_piece." + std::to_string(::getpid());
        m_bytes = beginningOfPiece("a head");
        m_ends.push_back(m_bytes.size());
        for (std::size_t i = 0; i < 3; ++i) {
            appendRecord(PieceRecord::kSums, std::vector<std::byte>(i * 10, std::byte{5}), m_bytes);
            m_ends.push_back(m_bytes.size());
        }
    }
    void TearDown() override { std::filesystem::remove(m_name); }

    // How far a file of these bytes holds, and how many records that is.
    std::pair<std::uint64_t, std::size_t> whole(const std::vector<std::byte>& bytes) {
        std::ofstream(m_name, std::ios::binary)
            .write(reinterpret_cast<const char*>(bytes.data()),
                   static_cast<std::streamsize>(bytes.size()));
        const OwnedFile file(m_name, O_RDONLY);
        PieceReader reader(file);
        std::size_t records = 0;
        while (reader.next()) ++records;
        EXPECT_EQ(reader.isBroken(), reader.wholeBytes() != bytes.size());
        EXPECT_EQ(reader.wholeBytes() + reader.brokenBytes(), bytes.size());
        return {reader.wholeBytes(), records};
    }
    // Of the record ends the last one at or before a place; the magic's end before the first.
    std::pair<std::uint64_t, std::size_t> endBefore(std::size_t place) const {
        std::size_t records = 0;
        while (records < m_ends.size() && m_ends[records] <= place) ++records;
        if (records == 0) return {place < 8 ? 0 : 8, 0};
        return {m_ends[records - 1], records};
    }

    std::string m_name;
    std::vector<std::byte> m_bytes;
    std::vector<std::size_t> m_ends;
};

TEST_F(PieceFile, HoldsUpToTheCut) {
    EXPECT_EQ(whole(m_bytes).second, 4u);
    for (std::size_t size = 0; size < m_bytes.size(); ++size) {
        const std::vector<std::byte> cut(m_bytes.begin(),
                                         m_bytes.begin() + static_cast<std::ptrdiff_t>(size));
        EXPECT_EQ(whole(cut), endBefore(size)) << size;
    }
}

TEST_F(PieceFile, AFlippedBitInAnyByteIsFound) {
    for (std::size_t at = 0; at < m_bytes.size(); ++at) {
        auto bytes = m_bytes;
        bytes[at] ^= std::byte(1u << (at * 5 + at / 8) % 8);
        EXPECT_EQ(whole(bytes), endBefore(at)) << at;
    }
}

TEST_F(PieceFile, ZerosAreNoRecord) {
    auto bytes = m_bytes;
    bytes.resize(bytes.size() + 4096);
    EXPECT_EQ(whole(bytes).first, m_bytes.size());
}

TEST_F(PieceFile, AreasComeBack) {
    std::vector<std::byte> payload;
    appendArea({7, {-3, 4, 5, 60}}, payload);
    payload.push_back(std::byte{9});
    std::span<const std::byte> rest = payload;
    const PieceArea area = takeArea(rest);
    EXPECT_EQ(area.pass, 7u);
    EXPECT_EQ(area.rect, (Rect{-3, 4, 5, 60}));
    EXPECT_EQ(rest.size(), 1u);
    EXPECT_ANY_THROW(takeArea(rest));
}

TEST_F(PieceFile, ALockIsAlone) {
    whole(m_bytes);
    const OwnedFile first(m_name, O_RDWR);
    EXPECT_TRUE(first.lock());
    EXPECT_TRUE(first.isAtItsName());
    {
        const OwnedFile second(m_name, O_RDWR);
        EXPECT_FALSE(second.lock());
    }
    std::filesystem::rename(m_name, m_name + ".other");
    EXPECT_FALSE(first.isAtItsName());
    std::filesystem::rename(m_name + ".other", m_name);
}

}  // namespace

}  // namespace pm::plugin::test
