// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Parts that were put together have the bits of a picture rendered at once; what is missing,
// damaged or of another picture is named.
#include <array>
#include <cstring>
#include <filesystem>

#include "plugin/storage/piece_file.h"
#include "tests/pieces/piece_host.h"

namespace pm::test {

namespace {

class Merge : public PieceHost {
  protected:
    void SetUp() override {
        PieceHost::SetUp();
        m_settings["passes"] = "2";
        ASSERT_EQ(PMR_OK, api().createMerge(m_host.context(), &m_merge));
    }
    void TearDown() override {
        EXPECT_EQ(PMR_OK, api().releaseMerge(m_merge));
        PieceHost::TearDown();
    }
    PmrStatus add(const std::string& name) { return api().addPart(m_merge, path(name).c_str()); }
    std::string missing() {
        return textOf([&](char* buffer, std::uint64_t capacity, std::uint64_t* needed) {
            return api().mergeMissing(m_merge, buffer, capacity, needed);
        });
    }
    std::vector<float> layer(const char* name, std::size_t channels) {
        std::vector<float> pixels(40 * 28 * channels, -7.0f);
        const PmrRectangle frame{0, 0, 40, 28};
        EXPECT_EQ(PMR_OK, api().readMergedPixels(m_merge, &frame, name, pixels.data(), 0, 0))
            << m_host.lastError();
        return pixels;
    }
    Outcome merged() {
        Outcome outcome;
        outcome.beauty = layer("beauty", 4);
        outcome.standardError = layer("stderr", 3);
        outcome.samples = layer("samples", 1);
        outcome.json = nlohmann::json::parse(
            textOf([&](char* buffer, std::uint64_t capacity, std::uint64_t* needed) {
                return api().mergeStatistics(m_merge, buffer, capacity, needed);
            }));
        return outcome;
    }
    void expectRefusal(const std::string& name, PmrStatus status, const std::string& text) {
        EXPECT_EQ(status, add(name));
        const std::string error = m_host.lastError();
        EXPECT_NE(std::string::npos, error.find(path(name))) << error;
        EXPECT_NE(std::string::npos, error.find(text)) << error;
    }

    PmrMerge m_merge = nullptr;
};

// A head that claims a frame, buckets or a length that no memory has, with the right checksums.
TEST_F(Merge, HeadsThatClaimTooMuch) {
    makePart("a", "1/2");
    const std::string bytes = readFile(path("a"));
    constexpr std::size_t kLengthAt = 16, kTextAt = 32;
    std::uint64_t length = 0;
    std::memcpy(&length, bytes.data() + kLengthAt, sizeof length);
    const auto writeWith = [&](const char* side, std::uint64_t bucketCount) {
        auto head = nlohmann::ordered_json::parse(bytes.substr(kTextAt, length));
        for (auto& setting : head["settings"])
            if (setting[0] == "width" || setting[0] == "height") setting[1] = side;
        head["bucketCount"] = bucketCount;
        const auto begin = plugin::beginningOfPiece(head.dump());
        writeFile(path("b"),
                  std::string(reinterpret_cast<const char*>(begin.data()), begin.size()) +
                      bytes.substr(kTextAt + length));
    };
    writeWith("65536", 20);
    expectRefusal("b", PMR_ERROR_FILE, "20 buckets for 65536 x 65536 pixels");
    writeWith("40", 4'000'000'000);
    expectRefusal("b", PMR_ERROR_FILE, "4000000000 buckets for 40 x 40 pixels");
    writeWith("65536", 5000);
    expectRefusal("b", PMR_ERROR_MEMORY, "its picture of 65536 x 65536 pixels takes");
    // A head of a terabyte, in a file with holes.
    const std::uint64_t claimed = std::uint64_t{1} << 40;
    std::string hollow = bytes;
    std::memcpy(hollow.data() + kLengthAt, &claimed, sizeof claimed);
    writeFile(path("b"), hollow);
    std::filesystem::resize_file(path("b"), claimed + 1000);
    expectRefusal("b", PMR_ERROR_FILE, "damaged or cut short at byte 8");
    EXPECT_EQ(PMR_OK, add("a")) << "the merge is as it was";
}

TEST_F(Merge, PartsInAnyOrderAreThePicture) {
    makePart("a", "1/3");
    makePart("b", "6:13", {{"threads", "3"}});
    makePart("c", "3/3");
    EXPECT_EQ(PMR_OK, add("c")) << m_host.lastError();
    EXPECT_EQ("0:13\n", missing());
    EXPECT_EQ(PMR_OK, add("a")) << m_host.lastError();
    EXPECT_EQ("6:13\n", missing());
    EXPECT_EQ(PMR_OK, add("b")) << m_host.lastError();
    EXPECT_EQ("", missing());
    expectSameBits(render({}), merged());
    std::uint32_t layers = 0;
    EXPECT_EQ(PMR_OK, api().mergeLayerCount(m_merge, &layers));
    EXPECT_EQ(7u, layers);
    PmrLayerInfo info = PMR_INIT(PmrLayerInfo);
    EXPECT_EQ(PMR_OK, api().mergeLayerInfo(m_merge, 6, &info));
    EXPECT_STREQ("samples", info.name);
    EXPECT_EQ(PMR_ERROR_ARGUMENT, api().mergeLayerInfo(m_merge, 7, &info));
    EXPECT_EQ("40", textOf([&](char* buffer, std::uint64_t capacity, std::uint64_t* needed) {
                  return api().mergeSettingText(m_merge, "width", buffer, capacity, needed);
              }));
}

// Where passes share no noise a part's sums hold what its passes weigh, too.
TEST_F(Merge, PartsOfPathsAreThePicture) {
    m_settings["integrator"] = "path";
    makePart("a", "1/2");
    render({{"buckets", "2/2"}, {"checkpoint", path("c")}}, 7);
    makePart("b", "2/2", {{"checkpoint", path("c")}, {"resume", "1"}});
    EXPECT_EQ(PMR_OK, add("b")) << m_host.lastError();
    EXPECT_EQ(PMR_OK, add("a")) << m_host.lastError();
    expectSameBits(render({}), merged());
}

TEST_F(Merge, APartIsTheSameBytesWheneverItIsMade) {
    makePart("a", "3:9");
    makePart("b", "3:9", {{"threads", "4"}, {"timeLimitSeconds", "0"}});
    // Killed, and gone on with.
    render({{"buckets", "3:9"}, {"checkpoint", path("c")}}, 8);
    makePart("d", "3:9", {{"checkpoint", path("c")}, {"resume", "1"}});
    EXPECT_GT(readFile(path("a")).size(), 6u * 64u * 100u);
    EXPECT_TRUE(readFile(path("a")) == readFile(path("b")));
    EXPECT_TRUE(readFile(path("a")) == readFile(path("d")));
    // A task that was run twice does no harm.
    for (const char* part : {"a", "b", "a"}) EXPECT_EQ(PMR_OK, add(part)) << m_host.lastError();
    EXPECT_EQ("0:3\n9:20\n", missing());
}

TEST_F(Merge, DamagedPartsAreNamedAndAddNothing) {
    makePart("a", "0:11");
    makePart("b", "11:20");
    const std::string good = readFile(path("b"));
    EXPECT_EQ(PMR_OK, add("a"));
    for (std::size_t at = 0; at < good.size(); at += good.size() / 23) {
        std::string bytes = good;
        bytes[at] ^= 4;
        writeFile(path("b"), bytes);
        expectRefusal("b", PMR_ERROR_FILE, at < 8 ? "is no part" : "damaged");
        writeFile(path("b"), good.substr(0, at));
        expectRefusal("b", PMR_ERROR_FILE, at < 8 ? "is no part" : "damaged");
    }
    writeFile(path("b"), good + "x");
    expectRefusal("b", PMR_ERROR_FILE, "damaged");
    EXPECT_EQ("11:20\n", missing());
    expectRefusal("z", PMR_ERROR_IO, "can't be opened");
    render({{"checkpoint", path("c")}});
    expectRefusal("c", PMR_ERROR_FILE, "is a checkpoint");
    writeFile(path("b"), good);
    EXPECT_EQ(PMR_OK, add("b"));
    EXPECT_EQ("", missing());
    expectSameBits(render({}), merged());
}

TEST_F(Merge, PartsOfAnotherPictureAreRefusedByWhatDiffers) {
    makePart("a", "0:11");
    EXPECT_EQ(PMR_OK, add("a"));
    for (const auto& [name, value, text] : std::vector<std::array<std::string, 3>>{
             {"seed", "2", "setting seed (2 there, 1 here)"},
             {"passes", "3", "passes (3 there, 2 here)"},
             {"bucketSize", "16", "buckets (16 pixels"},
             {"bucketOrder", "row", "in row order"},
             {"crop", "0,0,40,20", "window"},
             {"hostIdentity", "colour config: x", "colour config (x there, none here)"}}) {
        makePart("b", "2/2", {{name, value}});
        expectRefusal("b", PMR_ERROR_MISMATCH, text);
    }
    EXPECT_EQ("11:20\n", missing());
}

TEST_F(Merge, OverlappingPartsAreThePicture) {
    makePart("a", "0:11");
    makePart("b", "10:20");
    EXPECT_EQ(PMR_OK, add("b"));
    EXPECT_EQ(PMR_OK, add("a"));
    expectSameBits(render({}), merged());
}

TEST_F(Merge, WhatDoesNotGoTogetherIsRefusedAtTheStart) {
    for (const Settings& settings : std::vector<Settings>{{{"bucketSize", "0"}},
                                                          {{"bucketOrder", "correlated"}},
                                                          {{"timeLimitSeconds", "5"}},
                                                          {{"errorTarget", "0.1"}}}) {
        Settings all = settings;
        all["buckets"] = "1/2";
        const Outcome outcome = render(all);
        EXPECT_EQ(PMR_ERROR_ARGUMENT, outcome.started);
        EXPECT_NE(std::string::npos, outcome.error.find("buckets does not go together"))
            << outcome.error;
    }
    EXPECT_EQ(PMR_ERROR_ARGUMENT, render({{"buckets", "0:21"}}).started);
    EXPECT_EQ(PMR_ERROR_IO, render({{"part", path("no/a")}}).started);
    EXPECT_TRUE(files().empty());
}

TEST_F(Merge, BeforeTheFirstPartThereIsNothing) {
    std::uint32_t count = 0;
    EXPECT_EQ(PMR_ERROR_STATE, api().mergeLayerCount(m_merge, &count));
    EXPECT_EQ(PMR_ERROR_STATE, api().mergeMissing(m_merge, nullptr, 0, nullptr));
    EXPECT_EQ(PMR_ERROR_ARGUMENT, api().addPart(m_merge, nullptr));
    EXPECT_EQ(PMR_ERROR_ARGUMENT, api().createMerge(m_host.context(), nullptr));
    PmrMerge gone = nullptr;
    EXPECT_EQ(PMR_OK, api().createMerge(m_host.context(), &gone));
    EXPECT_EQ(PMR_OK, api().releaseMerge(gone));
    EXPECT_EQ(PMR_ERROR_HANDLE, api().releaseMerge(gone));
    EXPECT_EQ(PMR_ERROR_HANDLE, api().addPart(gone, "a"));
}

}  // namespace

}  // namespace pm::test
