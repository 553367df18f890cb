// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Photon-map files that were cut, damaged or made up: refused with their name, before the first
// pixel. Never another picture, never a crash, never more memory than the file is long.
#include <fcntl.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <functional>
#include <limits>
#include <random>

#include "integrator/photons/trace/photon_bytes.h"
#include "plugin/storage/piece_file.h"
#include "tests/pieces/photon_host.h"

namespace pm::test {

namespace {

class PhotonDamage : public PhotonHost {
  protected:
    // A record of the file.
    struct Record {
        plugin::PieceRecord kind;
        std::string payload;
        std::size_t at;  // its head
    };
    void SetUp() override {
        PhotonHost::SetUp();
        m_settings["passes"] = std::string("2");
        m_settings["photons"] = "300";
        makePhotons("m");
        m_bytes = readFile(path("m"));
        const plugin::OwnedFile file(path("m"), O_RDONLY);
        plugin::PieceReader reader(file);
        std::size_t at = reader.wholeBytes();
        while (reader.next()) {
            const auto payload = reader.payload();
            m_records.push_back({reader.kind(),
                                 {reinterpret_cast<const char*>(payload.data()), payload.size()},
                                 at});
            at = reader.wholeBytes();
        }
        // A head, two pilots, two kinds in each of two passes, an end.
        ASSERT_EQ(8u, m_records.size());
        ASSERT_EQ(m_bytes.size(), at);
    }
    void expectRefusal(const std::string& bytes, const std::string& what) {
        writeFile(path("m"), bytes);
        const Outcome refused = renderWith("m", {});
        EXPECT_EQ(PMR_ERROR_FILE, refused.started == PMR_OK ? refused.ended : refused.started)
            << what;
        EXPECT_NE(std::string::npos, refused.error.find(path("m"))) << what << refused.error;
        EXPECT_TRUE(std::ranges::all_of(refused.beauty, [](float v) { return v == 0.0f; })) << what;
    }
    // The file with one of its records changed, its checksums made anew.
    std::string forged(std::size_t record, const std::function<void(std::string&)>& change) const {
        std::vector<Record> records = m_records;
        change(records[record].payload);
        std::vector<std::byte> bytes;
        for (const Record& r : records)
            plugin::appendRecord(r.kind, std::as_bytes(std::span(r.payload)), bytes);
        return m_bytes.substr(0, plugin::kFirstRecordAt) +
               std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    }

    std::string m_bytes;
    std::vector<Record> m_records;
};

template <typename Value>
void put(std::string& payload, std::size_t at, Value value) {
    std::memcpy(payload.data() + at, &value, sizeof value);
}

TEST_F(PhotonDamage, CutAtEveryRecordAndBesideIt) {
    for (const Record& record : m_records)
        for (const int beside : {-1, 0, 1, 23, 25}) {
            const std::size_t at = record.at + static_cast<std::size_t>(beside + 1) - 1;
            expectRefusal(m_bytes.substr(0, at), fmt::format("cut at {}: ", at));
        }
    expectRefusal(m_bytes + "x", "longer: ");
    expectRefusal(m_bytes + m_bytes, "twice: ");
}

TEST_F(PhotonDamage, AFlippedBitAnywhere) {
    std::mt19937 random(3);
    for (int i = 0; i < 60; ++i) {
        std::string bytes = m_bytes;
        // The heads of records, which are a small part of it, as often as the rest.
        const std::size_t at =
            i % 2 == 0 ? random() % bytes.size() : m_records[random() % 8].at + random() % 24;
        bytes[at] ^= static_cast<char>(1u << (random() % 8));
        expectRefusal(bytes, fmt::format("flipped at {}: ", at));
    }
}

TEST_F(PhotonDamage, InPassesThatAreNotAskedForDoesNoHarm) {
    const Outcome whole = render({{"passes", "1"}});
    std::string bytes = m_bytes;
    bytes[m_records[6].at + 200] ^= 1;
    writeFile(path("m"), bytes);
    const Outcome read = renderWith("m", {{"passes", "1"}});
    expectSameBits(whole, read);
    expectRefusal(bytes, "the second pass: ");
}

TEST_F(PhotonDamage, WithRightChecksumsIsRefusedAsWell) {
    constexpr std::size_t kFocus = offsetof(TracedHead, focus);
    constexpr std::size_t kBalance = offsetof(TracedHead, balance);
    constexpr std::size_t kCounts = offsetof(TracedHead, photons);
    constexpr std::size_t kFirst = sizeof(TracedHead);
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const std::vector<std::pair<const char*, std::function<void(std::string&)>>> cases = {
        {"another kind", [](std::string& p) { put(p, 0, std::uint32_t{1}); }},
        {"another pass", [](std::string& p) { put(p, 4, std::uint32_t{1}); }},
        {"focus", [&](std::string& p) { put(p, kFocus + 4, nan); }},
        {"size of the focus", [](std::string& p) { put(p, kFocus + 12, -1.0f); }},
        {"stored", [](std::string& p) { put(p, kBalance + 8, std::uint64_t{3}); }},
        {"flux",
         [](std::string& p) { put(p, kBalance + 32, std::numeric_limits<double>::infinity()); }},
        {"more photons", [](std::string& p) { put(p, kCounts, std::uint64_t{1} << 62); }},
        {"descended", [](std::string& p) { put(p, kCounts + 8, ~std::uint64_t{0}); }},
        {"position", [&](std::string& p) { put(p, kFirst, nan); }},
        {"far away", [](std::string& p) { put(p, kFirst + 4, 1e30f); }},
        {"flux of a photon", [&](std::string& p) { put(p, kFirst + 28 + 12, nan); }},
        {"no side", [](std::string& p) { put(p, kFirst + 24, std::uint32_t{0}); }},
        {"half a photon", [](std::string& p) { p.resize(p.size() - 14); }},
        {"no photon's head", [](std::string& p) { p.resize(50); }}};
    ASSERT_TRUE(forged(3, [](std::string&) {}) == m_bytes);
    for (const auto& [what, change] : cases) expectRefusal(forged(3, change), what);
    expectRefusal(forged(7, [](std::string& p) { put(p, 0, std::uint64_t{3}); }), "end");
    const auto replace = [](const char* from, const char* to) {
        return [from, to](std::string& text) {
            const std::size_t at = text.find(from);
            ASSERT_NE(std::string::npos, at);
            text.replace(at, std::strlen(from), to);
        };
    };
    expectRefusal(forged(0, replace("\"passes\":2", "\"passes\":4000000000")), "passes");
    expectRefusal(forged(0, replace("{", "[")), "head");
    expectRefusal(forged(0, [](std::string& p) { p.assign(2 << 20, ' '); }), "long head");
}

}  // namespace

}  // namespace pm::test
