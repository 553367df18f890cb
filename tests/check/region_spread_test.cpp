// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Means of regions, and how far from them another render may be.
#include "host_shim/check/region_spread.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace pm::host {
namespace {

constexpr PixelRect kWindow{-4, 0, 44, 20};  // of 3 x 2 regions of 16, the lower ones 4 high

Picture plain(float value) {
    Picture picture{48, 20, kWindow, {}, {}};
    for (const char* name : {"R", "G", "B"})
        picture.channels.push_back(
            {name, true, std::vector<float>(static_cast<std::size_t>(kWindow.area()), value)});
    return picture;
}

TEST(RegionGrid, MeansAreOfTheirPixelsAlone) {
    const RegionGrid grid(kWindow, 16);
    EXPECT_EQ(grid.columns(), 3);
    EXPECT_EQ(grid.rows(), 2);
    EXPECT_EQ(grid.rect(2, 1), (PixelRect{28, 16, 44, 20}));
    Picture picture = plain(1);
    const PixelRect rect = grid.rect(1, 1);
    for (std::int32_t y = rect.y0; y < rect.y1; ++y)
        for (std::int32_t x = rect.x0; x < rect.x1; ++x)
            picture.channels[1]
                .values[static_cast<std::size_t>((y - kWindow.y0) * 48 + x - kWindow.x0)] = 3;
    const std::vector<double> means = grid.means(beautyOf(picture));
    ASSERT_EQ(means.size(), 18u);
    for (std::size_t i = 0; i < means.size(); ++i) EXPECT_EQ(means[i], i == 3 * 4 + 1 ? 3 : 1) << i;
}

TEST(RegionGrid, TheWholeIsOneRegion) {
    const RegionGrid grid(kWindow, 0);
    EXPECT_EQ(grid.columns() * grid.rows(), 1);
    EXPECT_EQ(grid.rect(0, 0), kWindow);
}

// Regions' means as renders of independent seeds have them.
std::vector<std::vector<double>> renders(std::size_t count, std::size_t regions, double deviation,
                                         std::mt19937& random) {
    std::normal_distribution<double> noise(0.0, deviation);
    std::vector<std::vector<double>> means(count, std::vector<double>(regions));
    for (auto& render : means)
        for (std::size_t i = 0; i < regions; ++i)
            render[i] = (1 + static_cast<double>(i % 7)) * (1 + noise(random));
    return means;
}

// 200 suites of 16 scenes of 6 regions and the whole: no false alarm, and a change of 2 % of one
// region of noise 0.15 % is found nearly always.
TEST(RegionSpread, NoFalseAlarmInTwoHundredSuites) {
    std::mt19937 random(7);
    int alarms = 0, found = 0;
    const int scenes = 200 * 16;
    for (int i = 0; i < scenes; ++i) {
        auto means = renders(18, 18, 0.0015, random);
        std::vector<double> fresh = means.back();
        means.pop_back();
        const RegionSpread spread = spreadOf(kWindow, 16, means);
        alarms += std::abs(furthestRegion(kWindow, spread, fresh).z) > spread.limit ? 1 : 0;
        fresh[7] *= 1.02;
        const RegionFinding finding = furthestRegion(kWindow, spread, fresh);
        const bool isFound = std::abs(finding.z) > spread.limit &&
                             finding.rect == RegionGrid(kWindow, 16).rect(2, 0) &&
                             finding.channel == 1;
        found += isFound ? 1 : 0;
    }
    EXPECT_EQ(alarms, 0);
    EXPECT_GT(found, scenes * 9 / 10);
}

TEST(RegionSpread, OneRegionOfMoreNoiseThanItsNeighboursIsNoAlarm) {
    std::mt19937 random(3);
    std::normal_distribution<double> noise(0.0, 0.05);
    int alarms = 0;
    for (int i = 0; i < 500; ++i) {
        auto means = renders(18, 18, 0.001, random);
        for (auto& render : means) render[9] *= 1 + noise(random);
        const std::vector<double> fresh = means.back();
        means.pop_back();
        const RegionSpread spread = spreadOf(kWindow, 16, means);
        alarms += std::abs(furthestRegion(kWindow, spread, fresh).z) > spread.limit ? 1 : 0;
    }
    EXPECT_EQ(alarms, 0);
}

// From tables of Student's t: beyond 8.0 of 16 degrees of freedom 5.6e-7, so the limit of 18
// regions.
TEST(RegionSpread, TheLimitIsStudents) {
    std::mt19937 random(5);
    EXPECT_NEAR(spreadOf(kWindow, 16, renders(17, 18, 0.003, random)).limit, 9.50, 0.01);
    EXPECT_NEAR(spreadOf(kWindow, 16, renders(10, 18, 0.003, random)).limit, 16.27, 0.01);
}

TEST(RegionSpread, SaysWhatItSees) {
    std::mt19937 random(5);
    const auto means = renders(17, 18, 0.003, random);
    const RegionSpread spread = spreadOf(kWindow, 16, means);
    EXPECT_NEAR(seenChange(spread), spread.limit * 0.003, 0.3 * spread.limit * 0.003);
    EXPECT_EQ(describe(RegionFinding{{16, 0, 32, 16}, 1, 9, -0.0203}),
              "region 16,0 to 32,16: G is 2.03 % darker");
}

TEST(RegionSpread, NothingIsFartherOffThanNan) {
    std::mt19937 random(5);
    auto means = renders(17, 18, 0.003, random);
    const RegionSpread spread = spreadOf(kWindow, 16, means);
    means[0][4] = std::nan("");
    means[0][9] *= 2;
    EXPECT_TRUE(std::isnan(furthestRegion(kWindow, spread, means[0]).z));
    EXPECT_EQ(furthestRegion(kWindow, spread, means[0]).rect, RegionGrid(kWindow, 16).rect(1, 0));
}

// One render of all shows light somewhere.
TEST(RegionSpread, LimitsAreFinite) {
    std::vector<std::vector<double>> means(5, std::vector<double>(18, 0.0));
    means[2][7] = 1;
    EXPECT_EQ(spreadOf(kWindow, 16, means).limit, 100);
}

TEST(RegionSpread, BlackThatStaysBlackIsRightAndLightInItIsNot) {
    const std::vector<std::vector<double>> means(5, std::vector<double>(18, 0.0));
    const RegionSpread spread = spreadOf(kWindow, 16, means);
    std::vector<double> fresh(18, 0.0);
    EXPECT_EQ(furthestRegion(kWindow, spread, fresh).z, 0);
    fresh[4] = 1e-4;
    EXPECT_GT(furthestRegion(kWindow, spread, fresh).z, spread.limit);
}

}  // namespace
}  // namespace pm::host
