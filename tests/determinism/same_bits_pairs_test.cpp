// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// The promise of the same bits, P14 and P16 of the paper of Yavuz et al. 2010, of the whole
// renderer through the C interface: all that a host may choose without a say in the picture, every
// two choices together at least once, on a scene with every kind of transport. With
// PM_FULL_MATRIX=N in the environment every N-th of all combinations.
#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>
#include <stdlib.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <iostream>
#include <locale>
#include <sstream>
#include <stdexcept>

#include "tests/abi/host.h"
#include "tests/determinism/covering_set.h"
#include "tests/determinism/picture_way.h"

namespace pm::test {

namespace {

constexpr PmrRectangle kFrame = {0, 0, 96, 72};
constexpr const char* kCommaLocale = "de_DE.UTF-8";

// The factors of a combination, in its order.
enum Factor { kThreads, kSize, kOrder, kWindow, kResume, kParts, kFlush, kLocale };

const std::vector<int> kThreadCounts = {1, 2, 3, 8};
const std::vector<int> kSizes = {8, 24, 32, 64, 128};  // the last: one bucket holds any window
// The frame, a crop on no boundary of buckets or of 8 x 8 pixels, more than the frame.
const std::vector<PmrRectangle> kWindows = {kFrame, {13, 7, 61, 50}, {-11, -5, 103, 75}};

// All that the library has, by its own account.
std::vector<std::string> bucketOrders() {
    std::vector<std::string> orders;
    for (std::uint32_t i = 0; i < api().settingCount(); ++i) {
        PmrSettingInfo info = PMR_INIT(PmrSettingInfo);
        EXPECT_EQ(PMR_OK, api().settingInfo(i, &info));
        if (std::strcmp(info.name, "bucketOrder") != 0) continue;
        std::istringstream choices(info.choices);
        for (std::string order; std::getline(choices, order, ',');) orders.push_back(order);
    }
    return orders;
}

std::string everyLayer() {
    std::string names;
    for (std::uint32_t i = 0; i < api().layerCount(); ++i) {
        PmrLayerInfo info = PMR_INIT(PmrLayerInfo);
        EXPECT_EQ(PMR_OK, api().layerInfo(i, &info));
        if (info.isDefault == 0) names += (names.empty() ? "" : ",") + std::string(info.name);
    }
    return names;
}

class SameBitsPairs : public ::testing::Test {
  protected:
    void SetUp() override {
        std::string name = ::testing::TempDir() + "pm_same_bits.XXXXXX";
        ASSERT_NE(mkdtemp(name.data()), nullptr);
        m_folder = name;
        m_texture = m_folder / "floor.ppm";
        writeFloorTexture(m_texture);
        m_settings["layers"] = everyLayer();
    }
    void TearDown() override {
        if (m_hasLocalePath) unsetenv("LOCPATH");
        std::error_code ignored;
        std::filesystem::remove_all(m_folder, ignored);
    }

    LayeredPicture make(const Way& way) {
        return makePicture(way, m_settings, {.texture = m_texture}, m_folder, m_interruptions);
    }

    // Makes the locale with localedef where it is not installed.
    bool hasCommaLocale() {
        const std::string command = "localedef -i de_DE -f UTF-8 '" +
                                    (m_folder / kCommaLocale).string() + "' >/dev/null 2>&1";
        if (std::system(command.c_str()) == 0)
            m_hasLocalePath = setenv("LOCPATH", m_folder.c_str(), 1) == 0;
        try {
            return std::use_facet<std::numpunct<char>>(std::locale(kCommaLocale)).decimal_point() ==
                   ',';
        } catch (const std::runtime_error&) {
            std::cout << "no locale with a comma, and none can be made: left out\n";
            return false;
        }
    }

    Combinations matrix() {
        const int orders = static_cast<int>(m_orders.size());
        const auto count = [](const auto& levels) { return static_cast<int>(levels.size()); };
        // Parts have to know their buckets beforehand.
        const auto isAllowed = [this](const Combination& c) {
            return c[kParts] == 0 || m_orders[static_cast<std::size_t>(c[kOrder])] != "correlated";
        };
        return fullMatrix({count(kThreadCounts), count(kSizes), orders, count(kWindows), 2, 2, 2,
                           hasCommaLocale() ? 2 : 1},
                          isAllowed);
    }

    Way wayOf(const Combination& c) const {
        const auto at = [&](const auto& levels, Factor factor, int further = 0) {
            return levels[static_cast<std::size_t>(c[factor] + further) % levels.size()];
        };
        Way way;
        way.threads = at(kThreadCounts, kThreads);
        way.bucketSize = at(kSizes, kSize);
        way.order = at(m_orders, kOrder);
        way.window = at(kWindows, kWindow);
        way.isCropped = c[kWindow] != 0;
        if (c[kResume] != 0) {
            way.resumeThreads = at(kThreadCounts, kThreads, 1);
            way.resumeBucketSize = at(kSizes, kSize, 2);
        }
        way.isInParts = c[kParts] != 0;
        way.flushesDenormals = c[kFlush] != 0;
        way.locale = c[kLocale] != 0 ? kCommaLocale : "";
        return way;
    }

    // Each of them beside a plain render of the frame and, where they go beyond it, of more.
    void expectSame(const Combinations& combinations) {
        const LayeredPicture frame = make(Way{.window = kFrame});
        const LayeredPicture more = make(Way{.window = kWindows.back(), .isCropped = true});
        EXPECT_EQ("", difference(more, frame));
        for (const Combination& combination : combinations) {
            const Way way = wayOf(combination);
            const LayeredPicture picture = make(way);
            EXPECT_EQ("", difference(picture, more)) << way.text();
        }
        const auto& [withinAPass, betweenPasses, tooLate] = m_interruptions;
        EXPECT_EQ(withinAPass + betweenPasses + tooLate,
                  std::ranges::count_if(combinations, [](const auto& c) { return c[kResume]; }));
        std::cout << combinations.size() << " combinations; resumed within a pass " << withinAPass
                  << ", between passes " << betweenPasses << ", at the end " << tooLate << "\n";
    }

    // The test as a host that lets TBB have more threads than the machine has: real concurrency.
    oneapi::tbb::global_control m_limit{oneapi::tbb::global_control::max_allowed_parallelism, 8};
    std::filesystem::path m_folder;
    std::string m_texture;
    bool m_hasLocalePath = false;
    std::vector<std::string> m_orders = bucketOrders();
    Interruptions m_interruptions;
    // Three passes: samples are given by need from the third on.
    Settings m_settings = {{"width", "96"},         {"height", "72"},   {"passes", "3"},
                           {"photons", "2000"},     {"aaLevel", "2"},   {"aaLevelMost", "3"},
                           {"aaThreshold", "0.05"}, {"gatherRays", "4"}};
};

TEST_F(SameBitsPairs, SceneHasEveryTransport) {
    const LayeredPicture picture = make(Way{.window = kFrame});
    EXPECT_EQ(picture.layers.size(), api().layerCount());
    for (const LayerPixels& layer : picture.layers) {
        const auto lit = std::ranges::count_if(layer.values, [](float v) { return v > 0.0f; });
        EXPECT_GT(lit, layer.name == "emission" ? 20 : 1000) << layer.name;
        if (layer.name != "samples") continue;
        const auto [least, most] = std::ranges::minmax(layer.values);
        EXPECT_LT(least, most) << "all pixels have as many samples";
    }
}

TEST_F(SameBitsPairs, EveryTwoChoicesTogether) {
    expectSame(coveringSet(matrix()));
    // Resuming is tested where something was left to do, and most of all within a pass. Where a
    // cancel falls is a matter of time: asked of many resumed renders only.
    const auto& [withinAPass, betweenPasses, tooLate] = m_interruptions;
    EXPECT_GT(withinAPass, 0);
    EXPECT_GT(withinAPass + betweenPasses, tooLate);
}

// Where pixels of four begin as one, and samples lie outside of theirs.
TEST_F(SameBitsPairs, LevelZeroAndAWideFilter) {
    m_settings["aaLevel"] = "0";
    m_settings["filter"] = "gaussian";
    const LayeredPicture picture = make(Way{.window = kFrame});
    for (const LayerPixels& layer : picture.layers) {
        if (layer.name != "aalevel") continue;
        const auto groups = std::ranges::count(layer.values, 0.0f);
        EXPECT_GT(groups, 500);
        EXPECT_LT(groups, 6400);
    }
    Combinations some;
    const Combinations all = coveringSet(matrix());
    for (std::size_t i = 0; i < all.size(); i += 5) some.push_back(all[i]);
    expectSame(some);
}

TEST_F(SameBitsPairs, FullMatrix) {
    const char* asked = getenv("PM_FULL_MATRIX");
    const int step = asked == nullptr ? 0 : std::atoi(asked);
    if (step < 1) GTEST_SKIP() << "takes about an hour; PM_FULL_MATRIX=1 asks for it";
    Combinations some;
    const Combinations all = matrix();
    for (std::size_t i = 0; i < all.size(); i += static_cast<std::size_t>(step))
        some.push_back(all[i]);
    expectSame(some);
}

// What the comparison is for, seen and named: one bit of one pixel, another seed.
TEST_F(SameBitsPairs, DifferencesAreNamed) {
    const Way way{.window = kFrame};
    const LayeredPicture expected = make(way);
    LayeredPicture broken = expected;
    float& value = broken.layers[2].values[(5 * 96 + 7) * 3 + 1];
    value = std::nextafter(value, 1e9f);
    const std::string text = difference(broken, expected);
    EXPECT_NE(std::string::npos, text.find("pixel 7,5, layer indirect, channel indirect.G"))
        << text;
    EXPECT_NE(std::string::npos, text.find("1 of 6912 pixels differ")) << text;
    m_settings["seed"] = "2";
    EXPECT_NE("", difference(make(way), expected));
}

}  // namespace

}  // namespace pm::test
