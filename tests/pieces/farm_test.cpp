// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Three machines render runs of one picture's buckets, and pm_host merge makes the picture of them:
// the command line of docs/farm.md.
#include <cstring>
#include <nlohmann/json.hpp>
#include <span>

#include "plugin/storage/piece_file.h"
#include "tests/robust/host_process.h"

namespace pm::host::test {
namespace {

class Farm : public HostProcess {
  protected:
    std::vector<std::string> command(std::vector<std::string> more) const {
        std::vector<std::string> arguments{
            "box.obj", "--size",        "40x28", "--passes", "2",         "--aa",      "2",
            "-q",      "--bucket-size", "8",     "--aov",    "N,samples", "--photons", "1000"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return arguments;
    }
    void makeParts(const std::vector<std::string>& more = {}) const {
        for (const char* run : {"1", "2", "3"}) {
            std::vector<std::string> arguments =
                command({"--buckets", std::string(run) + "/3", "-o",
                         std::string("p") + run + ".pmpart", "--threads", run});
            arguments.insert(arguments.end(), more.begin(), more.end());
            const Outcome outcome = this->run(arguments);
            ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
        }
    }
    Outcome merge(std::vector<std::string> more = {}) const {
        std::vector<std::string> arguments{"merge", "p1.pmpart", "p2.pmpart", "p3.pmpart",
                                           "-o",    "m.exr",     "-q"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return run(arguments);
    }
    // The text of standard error tells all of these, and there is no picture.
    void expectNoPicture(const Outcome& outcome, const std::vector<std::string>& parts) const {
        EXPECT_EQ(outcome.exitCode, 3) << outcome.err;
        for (const std::string& part : parts)
            EXPECT_NE(outcome.err.find(part), std::string::npos) << part << " in " << outcome.err;
        EXPECT_FALSE(fs::exists(path("m.exr")));
    }
};

TEST_F(Farm, MergedPartsAreTheBytesOfALocalRender) {
    makeParts({"--exposure", "auto"});
    EXPECT_EQ(leftFiles(), (std::vector<std::string>{"p1.pmpart", "p2.pmpart", "p3.pmpart"}));
    ASSERT_EQ(run(command({"-o", "a.exr", "-o", "a.png"})).exitCode, 0);
    const Outcome merged =
        merge({"-o", "m.png", "--stats", "s.json", "--reference", "a.exr", "--error-limit", "0"});
    ASSERT_EQ(merged.exitCode, 0) << merged.err;
    EXPECT_EQ(merged.out, "relMSE 0\n");
    EXPECT_TRUE(readText(path("m.exr")) == readText(path("a.exr")));
    EXPECT_TRUE(readText(path("m.png")) == readText(path("a.png")));
    const auto json = nlohmann::json::parse(readText(path("s.json")));
    EXPECT_EQ(json.at("passesDone"), 2);
    EXPECT_EQ(json.at("stopReason"), "passes done");
    EXPECT_EQ(json.at("exitCode"), 0);
}

// A part whose head says another vendor, with its checksum put right.
std::string byAnotherVendor(const std::string& part) {
    constexpr std::size_t kMagicBytes = 8, kRecordHeadBytes = 24, kLengthAt = kMagicBytes + 8;
    std::uint64_t length = 0;
    std::memcpy(&length, part.data() + kLengthAt, sizeof length);
    auto head = nlohmann::ordered_json::parse(part.substr(kMagicBytes + kRecordHeadBytes, length));
    EXPECT_FALSE(head.at("processorVendor").get<std::string>().empty());
    head["processorVendor"] = "Another one";
    const std::string text = head.dump();
    std::vector<std::byte> record;
    plugin::appendRecord(plugin::PieceRecord::kHead, std::as_bytes(std::span(text)), record);
    return part.substr(0, kMagicBytes) +
           std::string(reinterpret_cast<const char*>(record.data()), record.size()) +
           part.substr(kMagicBytes + kRecordHeadBytes + length);
}

TEST_F(Farm, UnlikeVendorsAreTold) {
    makeParts();
    const Outcome alike = merge({"--stats", "one.json"});
    ASSERT_EQ(alike.exitCode, 0) << alike.err;
    EXPECT_EQ(alike.err.find("vendor"), std::string::npos) << alike.err;
    const std::string picture = readText(path("m.exr"));
    write("p2.pmpart", byAnotherVendor(readText(path("p2.pmpart"))));
    const Outcome mixed = merge({"--stats", "two.json"});
    ASSERT_EQ(mixed.exitCode, 0) << mixed.err;
    EXPECT_NE(mixed.err.find("unlike vendors"), std::string::npos) << mixed.err;
    EXPECT_NE(mixed.err.find("Another one"), std::string::npos) << mixed.err;
    EXPECT_TRUE(readText(path("m.exr")) == picture);
    const auto vendors = [this](const char* file) {
        return nlohmann::json::parse(readText(path(file))).at("processorVendors").size();
    };
    EXPECT_EQ(vendors("one.json"), 1u);
    EXPECT_EQ(vendors("two.json"), 2u);
}

// Parts keep how bright they are to be shown; a merge may be told otherwise.
TEST_F(Farm, ExposureIsOfThePartsOrOfTheMerge) {
    makeParts();
    ASSERT_EQ(run(command({"-o", "zero.exr", "-o", "zero.png", "--exposure", "0"})).exitCode, 0);
    ASSERT_EQ(run(command({"-o", "two.exr", "-o", "two.png", "--exposure", "2"})).exitCode, 0);
    ASSERT_EQ(merge({"-o", "m.png"}).exitCode, 0);
    EXPECT_TRUE(readText(path("m.png")) == readText(path("zero.png")));
    ASSERT_EQ(merge({"-o", "m.png", "--exposure", "2"}).exitCode, 0);
    EXPECT_TRUE(readText(path("m.png")) == readText(path("two.png")));
    fs::remove(path("m.exr"));
    expectNoPicture(merge({"-o", "m.png", "--exposure", "auto"}), {"hold no measured exposure"});
    ASSERT_EQ(run(command({"--buckets", "2/3", "-o", "p2.pmpart", "--exposure", "2"})).exitCode, 0);
    expectNoPicture(merge({"-o", "m.png"}), {"not of one exposure", "--exposure STOPS"});
    ASSERT_EQ(merge().exitCode, 0) << "no display picture, no exposure";
    makeParts({"--exposure", "2"});
    ASSERT_EQ(merge({"-o", "m.png"}).exitCode, 0);
    EXPECT_TRUE(readText(path("m.png")) == readText(path("two.png")));
}

TEST_F(Farm, DisplayAndViewAreOfTheMerge) {
    makeParts({"--rendering-space", "ACEScg"});
    ASSERT_EQ(run(command({"-o", "a.exr", "-o", "a.png", "--rendering-space", "ACEScg", "--view",
                           "untone-mapped"}))
                  .exitCode,
              0);
    const Outcome merged = merge({"-o", "m.png", "--view", "untone-mapped"});
    ASSERT_EQ(merged.exitCode, 0) << merged.err;
    EXPECT_TRUE(readText(path("m.exr")) == readText(path("a.exr")));
    EXPECT_TRUE(readText(path("m.png")) == readText(path("a.png")));
    fs::remove(path("m.exr"));
    expectNoPicture(merge({"--rendering-space", "ACES2065-1"}), {"ACEScg", "ACES2065-1"});
}

TEST_F(Farm, WhatIsMissingIsRenderedAgain) {
    makeParts();
    ASSERT_EQ(run(command({"-o", "a.exr"})).exitCode, 0);
    fs::remove(path("p2.pmpart"));
    const Outcome without = merge();
    expectNoPicture(without, {"p2.pmpart", "buckets are missing: 6:13; make"});
    EXPECT_EQ(without.out, "6:13\n");
    // What the output says is what --buckets takes.
    const std::string range = without.out.substr(0, without.out.size() - 1);
    ASSERT_EQ(run(command({"--buckets", range, "-o", "p2.pmpart"})).exitCode, 0);
    ASSERT_EQ(merge().exitCode, 0);
    EXPECT_TRUE(readText(path("m.exr")) == readText(path("a.exr")));
}

TEST_F(Farm, CorruptPartsAreNamed) {
    makeParts();
    std::string bytes = readText(path("p3.pmpart"));
    bytes[bytes.size() / 2] ^= 1;
    write("p3.pmpart", bytes);
    const Outcome corrupt = merge();
    expectNoPicture(corrupt, {"p3.pmpart: the part is damaged"});
    EXPECT_EQ(corrupt.out, "13:20\n");
    // A task that ran twice: one good part of the two is enough.
    ASSERT_EQ(run(command({"--buckets", "3/3", "-o", "again.pmpart"})).exitCode, 0);
    const Outcome enough = merge({"again.pmpart"});
    EXPECT_EQ(enough.exitCode, 0) << enough.err;
    EXPECT_NE(enough.err.find("p3.pmpart: the part is damaged"), std::string::npos);
}

TEST_F(Farm, PartsOfAnotherPictureAreRefused) {
    makeParts();
    ASSERT_EQ(run(command({"--buckets", "2/3", "-o", "p2.pmpart", "--seed", "5"})).exitCode, 0);
    const Outcome mixed = merge();
    expectNoPicture(mixed, {"p2.pmpart", "p1.pmpart", "setting seed (5 there, 1 here)"});
    EXPECT_EQ(mixed.errorLines(), 1u) << mixed.err;
    write("box.mtl", "newmtl light\nKd 0 0 0\nKe 5 5 5\nnewmtl wall\nKd 0.4 0.5 0.5\n");
    ASSERT_EQ(run(command({"--buckets", "2/3", "-o", "p2.pmpart"})).exitCode, 0);
    expectNoPicture(merge(), {"p2.pmpart", "differs in: materials"});
}

TEST_F(Farm, CommandLinesThatMakeNoSense) {
    const auto refused = [&](const std::vector<std::string>& more, const std::string& text) {
        const Outcome outcome = run(command(more));
        EXPECT_EQ(outcome.exitCode, 2) << outcome.err;
        EXPECT_EQ(outcome.errorLines(), 1u) << outcome.err;
        EXPECT_NE(outcome.err.find(text), std::string::npos) << outcome.err;
    };
    refused({"--buckets", "1/2"}, "--buckets needs -o NAME.pmpart");
    refused({"--buckets", "1/2", "-o", "a.exr", "-o", "a.pmpart"}, "--buckets needs");
    refused({"--buckets", "0:99", "-o", "a.pmpart"}, "20 buckets");
    refused({"--buckets", "3/2", "-o", "a.pmpart"}, "--buckets");
    refused({"--buckets", "1/2", "-o", "a.pmpart", "--time-limit", "3"}, "--time-limit");
    refused({"--buckets", "1/2", "-o", "a.pmpart", "--error-target", "3"}, "--error-target");
    refused({"--buckets", "1/2", "-o", "a.pmpart", "--bucket-size", "auto"}, "auto");
    refused({"--buckets", "1/2", "-o", "a.pmpart", "--bucket-order", "correlated"}, "correlated");
    refused({"-o", "a.pmpart", "-o", "b.pmpart"}, "one .pmpart");
    refused({"--resume"}, "--resume needs --checkpoint");
    refused({"--checkpoint", "box.obj"}, "also an input");
    EXPECT_EQ(run({"merge", "-o", "m.exr"}).exitCode, 2);
    EXPECT_EQ(run({"merge", "p1.pmpart"}).exitCode, 2);
    EXPECT_EQ(run({"merge", "p1.pmpart", "-o", "p1.pmpart"}).exitCode, 2);
    EXPECT_EQ(run({"merge", "absent.pmpart", "-o", "m.exr"}).exitCode, 3);
    EXPECT_TRUE(leftFiles().empty());
}

TEST_F(Farm, FinishedRendersGoOnWithMorePasses) {
    ASSERT_EQ(
        run(command({"--checkpoint", "c.pmcheck", "--keep-checkpoint", "-o", "a.exr"})).exitCode,
        0);
    const std::vector<std::string> more{"--checkpoint", "c.pmcheck", "--resume", "--passes", "5",
                                        "-o",           "b.exr",     "--stats",  "s.json"};
    ASSERT_EQ(run(command(more)).exitCode, 0);
    EXPECT_EQ(nlohmann::json::parse(readText(path("s.json"))).at("passesResumed"), 2);
    EXPECT_FALSE(fs::exists(path("c.pmcheck")));
    ASSERT_EQ(run(command({"--passes", "5", "-o", "c.exr"})).exitCode, 0);
    EXPECT_TRUE(readText(path("b.exr")) == readText(path("c.exr")));
}

}  // namespace
}  // namespace pm::host::test
