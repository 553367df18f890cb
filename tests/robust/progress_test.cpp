// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// --progress: what programs read of a render on its way, and that it goes on when nobody reads.
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <regex>

#include "tests/robust/host_process.h"

namespace pm::host::test {
namespace {

class ProgressLines : public HostProcess {
  protected:
    // A render of so many seconds.
    Outcome renderTelling(const std::string& style, const std::string& seconds) const {
        return run({"box.obj", "--size", "64x48", "--photons", "2000", "--time-limit", seconds,
                    "--bucket-size", "8", "-o", "a.exr", "--progress", style});
    }
    static std::vector<std::string> linesOf(const std::string& text) {
        std::vector<std::string> lines;
        std::istringstream stream(text);
        for (std::string line; std::getline(stream, line);) lines.push_back(line);
        return lines;
    }
};

TEST_F(ProgressLines, alfIsAllThatStandardOutputHas) {
    const Outcome outcome = renderTelling("alf", "1");
    ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
    const std::regex form("ALF_PROGRESS ([0-9]+)%");
    int before = -1;
    for (const std::string& line : linesOf(outcome.out)) {
        std::smatch match;
        ASSERT_TRUE(std::regex_match(line, match, form)) << line;
        const int percent = std::stoi(match[1]);
        EXPECT_GT(percent, before);
        before = percent;
    }
    EXPECT_EQ(before, 100);
    EXPECT_TRUE(outcome.out.ends_with("ALF_PROGRESS 100%\n"));
    EXPECT_EQ(outcome.err.find("ALF_PROGRESS"), std::string::npos);
}

TEST_F(ProgressLines, openjdTellsPercentAndStatus) {
    const Outcome outcome = renderTelling("openjd", "3");
    ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
    const std::vector<std::string> lines = linesOf(outcome.out);
    ASSERT_GE(lines.size(), 4u);
    ASSERT_EQ(lines.size() % 2, 0u);
    const std::regex percent("openjd_progress: ([0-9]+\\.[0-9])"), status("openjd_status: .+");
    double before = -1;
    for (std::size_t i = 0; i < lines.size(); i += 2) {
        std::smatch match;
        ASSERT_TRUE(std::regex_match(lines[i], match, percent)) << lines[i];
        EXPECT_TRUE(std::regex_match(lines[i + 1], status)) << lines[i + 1];
        EXPECT_GT(std::stod(match[1]), before);
        before = std::stod(match[1]);
    }
    EXPECT_TRUE(outcome.out.ends_with("openjd_progress: 100.0\nopenjd_status: done\n"));
    EXPECT_EQ(outcome.err.find("openjd"), std::string::npos);
}

TEST_F(ProgressLines, jsonIsOneObjectALine) {
    const Outcome outcome = renderTelling("json", "3");
    ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
    EXPECT_EQ(outcome.out, "");
    double fraction = 0, elapsed = -10;
    int told = 0;
    for (const std::string& line : linesOf(outcome.err)) {
        if (!line.starts_with("{")) continue;
        const auto json = nlohmann::json::parse(line);
        ASSERT_EQ(json.size(), 3u) << line;
        const double progress = json.at("progress"), seconds = json.at("elapsed_seconds");
        EXPECT_GE(progress, fraction);
        // At most one a second, but for the last.
        EXPECT_TRUE(seconds >= elapsed + 0.98 || progress == 1.0) << line;
        const auto& remaining = json.at("remaining_seconds");
        EXPECT_TRUE(remaining.is_null() || remaining.get<double>() >= 0) << line;
        // Counted from the start of the render, which is later than that of the process.
        if (seconds < 2.0) {
            EXPECT_TRUE(remaining.is_null()) << line;
        }
        told += !remaining.is_null();
        fraction = progress;
        elapsed = seconds;
    }
    EXPECT_EQ(fraction, 1.0);
    EXPECT_GE(told, 1);
}

TEST_F(ProgressLines, plainComesOnceASecondAtMost) {
    const Outcome outcome = renderTelling("plain", "2");
    ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
    EXPECT_EQ(outcome.out, "");
    const std::regex form(
        "Progress: ([0-9]+)%, [0-9:]+ elapsed, (remaining time not known yet|[0-9:]+ left)");
    int before = -1, lines = 0;
    for (const std::string& line : linesOf(outcome.err)) {
        if (!line.starts_with("Progress")) continue;
        std::smatch match;
        ASSERT_TRUE(std::regex_match(line, match, form)) << line;
        EXPECT_GT(std::stoi(match[1]), before);
        before = std::stoi(match[1]);
        ++lines;
    }
    EXPECT_EQ(before, 100);
    EXPECT_GE(lines, 2);
}

// Whoever reads goes away at once.
TEST_F(ProgressLines, aClosedPipeEndsNoRender) {
    for (const auto& [pipe, style] :
         {std::pair{"2>.err |", "alf"}, std::pair{"2>&1 >.out |", "plain"}}) {
        const std::string command =
            "cd " + m_folder.string() + " && { " + PM_HOST +
            " box.obj --size 64x48 --photons 2000 --time-limit 1 --bucket-size 8 -v -o a.exr"
            " --progress " +
            style + "; echo $? >code; } " + pipe + " true";
        EXPECT_EQ(std::system(command.c_str()), 0);
        EXPECT_EQ(readText(path("code")), "0\n") << style;
        EXPECT_TRUE(fs::exists(path("a.exr"))) << style;
        fs::remove(path("a.exr"));
        fs::remove(path("code"));
    }
    EXPECT_NE(readText(path(".err")).find("standard output is closed"), std::string::npos);
}

}  // namespace
}  // namespace pm::host::test
