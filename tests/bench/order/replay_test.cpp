// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// The replay of buckets on more workers than there are, and the plots of the paper's figures.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <numeric>
#include <random>
#include <sstream>

#include "integrator/values/error.h"
#include "tests/bench/order/bucket_replay.h"
#include "tests/bench/paper/paper_claims.h"
#include "tests/bench/plot/bar_plot.h"
#include "tests/bench/plot/ratios.h"
#include "tests/bench/plot/report.h"
#include "tests/bench/run/child_process.h"

namespace pm::bench {
namespace {

using Atoms = std::vector<std::vector<double>>;

double sumOf(const Atoms& atoms) {
    double sum = 0;
    for (const auto& bucket : atoms) sum = std::accumulate(bucket.begin(), bucket.end(), sum);
    return sum;
}

// Costs as frames have them: most alike, a few ten times as much.
Atoms unlikeAtoms(unsigned seed, std::size_t buckets) {
    std::mt19937 random(seed);
    Atoms atoms(buckets, std::vector<double>(16));
    for (auto& bucket : atoms) {
        const double dear = random() % 8 == 0 ? 10 : 1;
        for (double& atom : bucket) atom = dear * (1 + static_cast<double>(random() % 1000) / 1000);
    }
    return atoms;
}

TEST(Replay, OneWorkerTakesTheSum) {
    const Atoms atoms = unlikeAtoms(1, 40);
    for (const bool shares : {false, true}) {
        const Replay replay = replayBuckets(atoms, {1, shares, 0.25});
        EXPECT_NEAR(sumOf(atoms) + 40 * 0.25, replay.seconds, 1e-9);
        EXPECT_NEAR(replay.seconds, replay.busySeconds, 1e-9);
    }
}

TEST(Replay, EqualBucketsGoInRounds) {
    const Atoms atoms(12, std::vector<double>(4, 0.5));
    for (int workers = 1; workers <= 12; ++workers) {
        const double rounds = std::ceil(12.0 / workers);
        EXPECT_NEAR(2 * rounds, replayBuckets(atoms, {workers, false}).seconds, 1e-12) << workers;
        // Shared, it is rounds of atoms: 48 of them.
        EXPECT_NEAR(0.5 * std::ceil(48.0 / workers), replayBuckets(atoms, {workers, true}).seconds,
                    1e-12)
            << workers;
    }
    EXPECT_NEAR(3 * (2 + 0.1), replayBuckets(atoms, {4, false, 0.1}).seconds, 1e-12);
}

// Seven short buckets, then one of eight atoms of a second each, on four workers: three have two
// short ones and are free after 2 s, the fourth begins the long one at 1 s.
TEST(Replay, OneLongBucketKeepsOneWorkerOrIsShared) {
    Atoms atoms(7, std::vector<double>(1, 1.0));
    atoms.push_back(std::vector<double>(8, 1.0));
    EXPECT_NEAR(9, replayBuckets(atoms, {4, false}).seconds, 1e-12);
    // One atom until 2 s, the other seven by four: two more rounds.
    EXPECT_NEAR(4, replayBuckets(atoms, {4, true}).seconds, 1e-12);
    // Where it comes first, nobody waits.
    std::swap(atoms.front(), atoms.back());
    EXPECT_NEAR(8, replayBuckets(atoms, {2, false}).seconds, 1e-12);
    EXPECT_NEAR(7.5, sumOf(atoms) / 2, 1e-12);
}

TEST(Replay, NeitherFasterThanTheWorkNorSlowerThanItsLongestPart) {
    for (unsigned seed = 1; seed <= 20; ++seed) {
        const Atoms atoms = unlikeAtoms(seed, 30);
        double longestBucket = 0, longestAtom = 0;
        for (const auto& bucket : atoms) {
            longestBucket = std::max(longestBucket, sumOf({bucket}));
            longestAtom = std::max(longestAtom, *std::max_element(bucket.begin(), bucket.end()));
        }
        for (int workers = 1; workers <= 64; workers *= 2) {
            const double share = sumOf(atoms) / workers, most = 1 - 1.0 / workers;
            const double alone = replayBuckets(atoms, {workers, false}).seconds;
            const double shared = replayBuckets(atoms, {workers, true}).seconds;
            EXPECT_GE(alone, std::max(share, longestBucket) - 1e-9);
            EXPECT_GE(shared, std::max(share, longestAtom) - 1e-9);
            // Graham's bound for any list of jobs.
            EXPECT_LE(alone, share + most * longestBucket + 1e-9);
            EXPECT_LE(shared, share + most * longestAtom + 1e-9);
        }
    }
}

TEST(Replay, IsTheSameEachTime) {
    const Atoms atoms = unlikeAtoms(3, 50);
    const Replay first = replayBuckets(atoms, {7, true, 1e-3});
    for (int i = 0; i < 3; ++i) {
        const Replay again = replayBuckets(atoms, {7, true, 1e-3});
        EXPECT_EQ(first.seconds, again.seconds);
        EXPECT_EQ(first.busySeconds, again.busySeconds);
    }
    EXPECT_EQ(0, replayBuckets({}, {3, true}).seconds);
}

TEST(PartlySerial, ComesBackFromItsSpeedUp) {
    EXPECT_DOUBLE_EQ(0, serialShareOf(2, 2));
    EXPECT_DOUBLE_EQ(1, serialShareOf(1, 2));
    EXPECT_DOUBLE_EQ(1, serialShareOf(1, 1));
    EXPECT_DOUBLE_EQ(0, serialShareOf(3, 2));  // faster than can be is chance
    const PartlySerial part{6, serialShareOf(1.5, 2)};
    EXPECT_NEAR(1.0 / 3, part.serialShare, 1e-12);
    EXPECT_NEAR(6, part.with(1), 1e-12);
    EXPECT_NEAR(4, part.with(2), 1e-12);
    EXPECT_NEAR(2.5, part.with(8), 1e-12);
}

// Student's quantiles 12.7062, 3.1824 and 2.0930 for 1, 3 and 19 degrees of freedom.
TEST(Ratios, HaveStudentsInterval) {
    EXPECT_EQ("1.2500", showRatios({1.25}));
    const Interval two = intervalOf({1, std::exp(2.0)});
    EXPECT_NEAR(1, std::log(two.mean), 1e-12);
    EXPECT_NEAR(12.7062, std::log(two.high) - 1, 1e-3);
    const Interval four = intervalOf({1, 1, std::exp(2.0), std::exp(2.0)});
    EXPECT_NEAR(3.1824 * std::sqrt(4.0 / 3 / 4), std::log(four.high) - 1, 1e-3);
    std::vector<double> twenty(10, 1.0);
    twenty.resize(20, std::exp(2.0));
    EXPECT_NEAR(1 - 2.0930 * std::sqrt(20.0 / 19 / 20), std::log(intervalOf(twenty).low), 1e-3);
}

TEST(Verdict, IsWhatTheIntervalSays) {
    EXPECT_EQ("yes", verdictOn(0.41, {0.4, 0.3, 0.5}));
    EXPECT_EQ("less", verdictOn(0.67, {0.4, 0.3, 0.5}));
    EXPECT_EQ("yes, more", verdictOn(0.25, {0.4, 0.3, 0.5}));
    EXPECT_EQ("yes", verdictOn(0, {0.4, 0.3, 0.5}));
    EXPECT_EQ("no", verdictOn(0.67, {0.02, -0.01, 0.05}));
    EXPECT_EQ("the other way round", verdictOn(0, {-0.02, -0.03, -0.01}));
}

// Two turns in which eight workers take an eighth, row 1.25 and random twice as long as Hilbert's.
TEST(PaperTables, SavingsAreSharesOfTheTime) {
    OrdersTurn turn;
    for (std::size_t order = 0; order < turn.size(); ++order) {
        for (int k = 1; k <= kPaperWorkers; ++k)
            turn[order].replayed[static_cast<std::size_t>(k - 1)] =
                std::array{1.0, 1.25, 2.0, 1.0}[order] / k;
        turn[order].measured = {1.0};
    }
    Report report("test");
    reportPaperOrders(report, {{"s", 0.5, {turn, turn}, {{1.0, 1.0}}}});
    const std::string text = report.csv();
    EXPECT_NE(std::string::npos, text.find("\"67 %\",\"50.0 % (50.0 to 50.0)\",\"less\"")) << text;
    EXPECT_NE(std::string::npos, text.find("\"41 %\",\"20.0 % (20.0 to 20.0)\",\"less\""));
    EXPECT_NE(std::string::npos, text.find("\"25 %\",\"50.0 % (50.0 to 50.0)\",\"yes, more\""));
    EXPECT_NE(std::string::npos, text.find("\"85 %\",\"87.5 % (87.5 to 87.5)\",\"yes, more\""));
}

TEST(BarPlot, HeightsAreInProportion) {
    const TemporaryFolder folder;
    const auto file = folder.path() / "bars.svg";
    BarPanel panel{"a & b", "s", {"1", "2"}, {{{4, false}, {2, true}}, {{1, false}, {0, false}}}};
    writeSvg(file, BarPlot{{"row", "hilbert"}, {panel, panel}, "pale: replayed"});
    std::stringstream text;
    text << std::ifstream(file).rdbuf();
    const std::string svg = text.str();
    EXPECT_NE(std::string::npos, svg.find("a &amp; b"));
    std::vector<double> heights;
    for (std::size_t at = svg.find("class=\"bar\""); at != std::string::npos;
         at = svg.find("class=\"bar\"", at + 1)) {
        std::istringstream number(svg.substr(svg.find("height=\"", at) + 8, 12));
        number.imbue(std::locale::classic());
        double height = 0;
        number >> height;
        heights.push_back(height);
    }
    ASSERT_EQ(6u, heights.size());                   // what is not above 0 has no bar
    EXPECT_NEAR(heights[0] / 4, heights[1], 0.011);  // group by group
    EXPECT_NEAR(heights[0] / 2, heights[2], 0.011);
    EXPECT_EQ(heights[1], heights[4]);
    EXPECT_NE(std::string::npos, svg.find("fill-opacity"));
    EXPECT_THROW(writeSvg(folder.path() / "no" / "bars.svg", BarPlot{}), Error);
}

}  // namespace
}  // namespace pm::bench
