// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// What the figures of the benchmarks are made with.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <random>
#include <sstream>
#include <stdexcept>

#include "integrator/values/error.h"
#include "tests/bench/order/idle_share.h"
#include "tests/bench/plot/error_curve.h"
#include "tests/bench/plot/log_plot.h"
#include "tests/bench/plot/report.h"
#include "tests/bench/run/child_process.h"
#include "tests/bench/run/picture_error.h"

namespace pm::bench {
namespace {

std::string contentsOf(const std::filesystem::path& file) {
    std::ifstream in(file);
    std::stringstream text;
    text << in.rdbuf();
    return text.str();
}

TEST(Report, RowsHaveAsManyCellsAsTheHeader) {
    Report report("table");
    report.table("squares", {"n", "n^2"});
    report.row({"2", "4"});
    EXPECT_THROW(report.row({"3"}), std::logic_error);
    EXPECT_NE(std::string::npos, report.markdown().find("| n | n^2 |\n| --- | --- |\n| 2 | 4 |\n"));
}

TEST(Report, OnlyItsOwnPlaceInTheDocumentIsReplaced) {
    const TemporaryFolder folder;
    const std::string docs = (folder.path() / "docs.md").string();
    const auto place = [](const std::string& name, const std::string& held) {
        return "<!-- " + name + " begin -->\n" + held + "<!-- " + name + " end -->\n";
    };
    const std::string first = place("one", "measured before\n"), second = place("two", "old\n");
    std::ofstream(docs) << first << second;
    std::vector<Report> reports;
    reports.emplace_back("two").paragraph("new");
    publish(reports, "", docs);
    EXPECT_EQ(first + place("two", "\n" + reports[0].markdown() + "\n"), contentsOf(docs));
    // Of two that are measured one has no place: then neither is written.
    reports.emplace_back("three");
    const std::string before = contentsOf(docs);
    reports[0].paragraph("newer");
    EXPECT_THROW(publish(reports, "", docs), Error);
    EXPECT_EQ(before, contentsOf(docs));
}

TEST(SecondsTo, FollowsAStraightLineBetweenLogarithms) {
    const ErrorCurve curve{"s", "r", {{"1", 1, 2, 1e-2}, {"4", 4, 8, 2.5e-3}, {"9", 8, 16, 2e-3}}};
    EXPECT_EQ("2.00 (4.00)", secondsTo(5e-3, curve));
    EXPECT_EQ("< 1.00 (2.00)", secondsTo(2e-2, curve));
    EXPECT_EQ("8.00 (16.0)", secondsTo(2e-3, curve));
    EXPECT_EQ("-", secondsTo(1e-3, curve));
}

TEST(SecondsTo, IsNotFooledByNaN) {
    EXPECT_EQ("-", secondsTo(1e-2, {"s", "r", {{"1", 1, 2, std::nan("")}}}));
}

TEST(Curves, ComeBackFromTheirFile) {
    const TemporaryFolder folder;
    const auto file = folder.path() / "curves.csv";
    EXPECT_TRUE(readCurves(file).empty());
    writeCurves(file, {{"a", "x", {{"1 sample", 0.5, 1, 0.25}, {"2 samples", 1, 2, 1e-3}}},
                       {"a", "y", {{"quality 1", 3, 4, 0.125}}}});
    const std::vector<ErrorCurve> curves = readCurves(file);
    ASSERT_EQ(2u, curves.size());
    ASSERT_EQ(2u, curves[0].points.size());
    EXPECT_EQ("y", curves[1].renderer);
    EXPECT_EQ("2 samples", curves[0].points[1].budget);
    EXPECT_DOUBLE_EQ(0.5, curves[0].points[0].seconds);
    EXPECT_DOUBLE_EQ(2, curves[0].points[1].processorSeconds);
    EXPECT_DOUBLE_EQ(1e-3, curves[0].points[1].error);
}

TEST(Curves, ABadLineIsNamed) {
    const TemporaryFolder folder;
    const auto file = folder.path() / "curves.csv";
    std::ofstream(file) << "head\na,x,b,1,2,3\na,x,b,1,two,3\n";
    try {
        readCurves(file);
        FAIL() << "was read";
    } catch (const Error& e) {
        EXPECT_NE(std::string::npos, std::string(e.what()).find("curves.csv:3")) << e.what();
    }
}

// Two pictures with a bias of 0.01 each and much noise.
class CommonErrorTest : public testing::Test {
  protected:
    static constexpr std::size_t kValues = 3 * 20000;

    std::vector<double> noisy(double bias, unsigned seed) const {
        std::mt19937 random(seed);
        std::normal_distribution<double> noise(0, 0.1);
        std::vector<double> picture(kValues);
        for (double& value : picture) value = 1 + bias + noise(random);
        return picture;
    }
    const Yardstick m_yardstick{std::vector<double>(kValues, 1.0)};
};

TEST_F(CommonErrorTest, NoiseCancelsAndBiasStays) {
    const auto a = noisy(0.01, 1), b = noisy(0.01, 2);
    EXPECT_NEAR((0.01 + 0.0001) / 1.01, m_yardstick.relMse(a), 2e-4);
    EXPECT_NEAR(0.0001 / 1.01, m_yardstick.commonError(a, b), 1.5e-4);
    EXPECT_NEAR(0.01 / 1.01, m_yardstick.commonError(noisy(0.1, 1), noisy(0.1, 2)), 3e-4);
    EXPECT_NEAR(1.01, m_yardstick.meanOver(a), 2e-3);
}

TEST_F(CommonErrorTest, DifferenceOfTwoExpectationsAlone) {
    const double found = m_yardstick.commonDifference(noisy(0.15, 1), noisy(0.05, 2),
                                                      noisy(0.15, 3), noisy(0.05, 4));
    EXPECT_NEAR(0.01 / 1.01, found, 6e-4);
}

TEST_F(CommonErrorTest, WorstPixelsAreLeftOutButNotNaN) {
    Yardstick yardstick = m_yardstick;
    std::vector<double> picture(kValues, 1.0);
    picture[0] = 1000;
    EXPECT_GT(yardstick.relMse(picture), 1);
    yardstick.dropped = 0.001;
    EXPECT_EQ(0, yardstick.relMse(picture));
    yardstick.brightest = 20;
    EXPECT_DOUBLE_EQ(1, yardstick.meanOver(picture));
    picture[0] = std::nan("");
    EXPECT_TRUE(std::isnan(yardstick.relMse(picture)));
}

TEST(Plot, PointsLieWhereTheirLogarithmsAre) {
    const TemporaryFolder folder;
    const auto file = folder.path() / "plot.svg";
    writeSvg(file, {"t", "x", "y", {{"a < b", {{0.1, 1}, {1, 0.1}, {10, 0.01}}}}, 0, ""});
    const std::string svg = contentsOf(file);
    EXPECT_NE(std::string::npos, svg.find("a &lt; b"));
    // Three points a decade apart each way: the middle one is in the middle.
    std::vector<double> x, y;
    for (std::size_t at = svg.find("<circle"); at != std::string::npos;
         at = svg.find("<circle", at + 1)) {
        const auto number = [&](const char* name) {
            std::istringstream text(svg.substr(svg.find(name, at) + 4));
            text.imbue(std::locale::classic());
            double value = 0;
            text >> value;
            return value;
        };
        x.push_back(number("cx=\""));
        y.push_back(number("cy=\""));
    }
    ASSERT_EQ(3u, x.size());
    EXPECT_NEAR(x[1], (x[0] + x[2]) / 2, 0.11);
    EXPECT_NEAR(y[1], (y[0] + y[2]) / 2, 0.11);
    EXPECT_LT(x[0], x[2]);
    EXPECT_LT(y[0], y[2]);  // down in the picture is less
}

// Three buckets of four seconds each: the third keeps one of two workers waiting for four of
// sixteen.
TEST(IdleShare, IsWhatAScheduleOnPaperHas) {
    const std::vector<std::vector<double>> buckets(3, std::vector<double>(4, 1.0));
    EXPECT_DOUBLE_EQ(0.25, idleShare(buckets, 2, false));
    EXPECT_DOUBLE_EQ(0.0, idleShare(buckets, 2, true));
    EXPECT_DOUBLE_EQ(0.0, idleShare(buckets, 1, false));
    // Twelve atoms on eight workers take two seconds, in which they could do sixteen.
    EXPECT_DOUBLE_EQ(0.25, idleShare(buckets, 8, true));
    EXPECT_DOUBLE_EQ(1 - 12.0 / (8 * 4), idleShare(buckets, 8, false));
    EXPECT_DOUBLE_EQ(0.0, idleShare({}, 3, true));
}

TEST(Child, TellsExitCodeTimeAndOutput) {
    const TemporaryFolder folder;
    const ChildResult done =
        runChild({"sh", "-c", "pwd; i=0; while [ $i -lt 50000 ]; do i=$((i+1)); done; exit 7"},
                 folder.path(), folder.path() / "log");
    EXPECT_EQ(7, done.exitCode);
    EXPECT_GT(done.processorSeconds, 0.001);
    EXPECT_GT(done.seconds, 0.5 * done.processorSeconds);
    EXPECT_NE(std::string::npos, contentsOf(folder.path() / "log").find("pm_bench_"));
    EXPECT_EQ(127, runChild({"no-such-program-here"}, folder.path(), folder.path() / "l").exitCode);
    EXPECT_FALSE(findProgram("no-such-program-here").has_value());
}

}  // namespace
}  // namespace pm::bench
