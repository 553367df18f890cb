// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// The same bits whatever the threads, buckets, order, crop and host, through the C interface, on a
// scene with diffuse, glossy, mirror and glass parts.
#include <xmmintrin.h>

#include <cfenv>
#include <clocale>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <sstream>

#include "tests/abi/host.h"

namespace pm::test {

namespace {

using Settings = std::map<std::string, std::string>;

// Compares bits, so that a NaN would count too.
::testing::AssertionResult sameBits(const std::vector<float>& a, const std::vector<float>& b) {
    if (a.size() != b.size()) return ::testing::AssertionFailure() << "unlike sizes";
    std::size_t unlike = 0;
    for (std::size_t i = 0; i < a.size(); ++i)
        if (std::memcmp(&a[i], &b[i], sizeof(float)) != 0) ++unlike;
    if (unlike == 0) return ::testing::AssertionSuccess();
    return ::testing::AssertionFailure() << unlike << " of " << a.size() << " floats differ";
}

// The choices of a setting, as the library lists them.
std::vector<std::string> choicesOf(const std::string& setting) {
    std::vector<std::string> choices;
    for (std::uint32_t i = 0; i < api().settingCount(); ++i) {
        PmrSettingInfo info = PMR_INIT(PmrSettingInfo);
        EXPECT_EQ(PMR_OK, api().settingInfo(i, &info));
        if (setting != info.name) continue;
        std::stringstream text(info.choices);
        for (std::string choice; std::getline(text, choice, ',');) choices.push_back(choice);
    }
    return choices;
}

class Determinism : public ::testing::TestWithParam<const char*> {
  protected:
    std::vector<float> render(Settings settings, PmrRectangle rectangle = {0, 0, kWidth, kHeight}) {
        settings["integrator"] = GetParam();
        return renderBox(m_host, settings, rectangle);
    }
    BoxHost m_host;
};

TEST_P(Determinism, PictureIsAPicture) {
    double sum = 0;
    for (const float value : render({})) {
        ASSERT_TRUE(std::isfinite(value));
        sum += value;
    }
    EXPECT_GT(sum / (kWidth * kHeight * 4.0), 0.01);
}

TEST_P(Determinism, Threads) {
    const std::vector<float> one = render({{"threads", "1"}});
    EXPECT_TRUE(sameBits(one, render({{"threads", "2"}})));
    EXPECT_TRUE(sameBits(one, render({{"threads", "5"}})));
}

TEST_P(Determinism, BucketsAndOrders) {
    const std::vector<float> first = render({{"bucketSize", "16"}, {"threads", "1"}});
    for (const char* size : {"0", "8", "24", "32", "48", "256"})
        EXPECT_TRUE(sameBits(first, render({{"bucketSize", size}}))) << size;
    int orders = 0;
    for (const std::string& order : choicesOf("bucketOrder")) {
        EXPECT_TRUE(sameBits(first, render({{"bucketOrder", order}}))) << order;
        EXPECT_TRUE(sameBits(first, render({{"bucketOrder", order}, {"threads", "5"}}))) << order;
        ++orders;
    }
    EXPECT_EQ(7, orders);
}

TEST_P(Determinism, Crop) {
    const PmrRectangle inside = {5, 11, 42, 30};
    const std::vector<float> whole = render({}, inside);
    EXPECT_TRUE(sameBits(whole, render({{"crop", "5,11,42,30"}}, inside)));
    EXPECT_TRUE(sameBits(whole, render({{"crop", "-13,-9,100,60"}}, inside)));
}

TEST_P(Determinism, SeedMatters) {
    EXPECT_FALSE(sameBits(render({}), render({{"seed", "2"}})));
}

TEST_P(Determinism, HostsFloatingPointModes) {
    const std::vector<float> plain = render({{"threads", "2"}});
    constexpr unsigned kFlushToZero = 0x8000, kDenormalsAreZero = 0x0040;
    const unsigned before = _mm_getcsr();
    std::fesetround(FE_UPWARD);
    _mm_setcsr(_mm_getcsr() | kFlushToZero | kDenormalsAreZero);
    const unsigned modes = _mm_getcsr();
    const BoxHost host;  // so that the scene is built under them as well
    const std::vector<float> strange =
        renderBox(host, {{"threads", "2"}, {"integrator", GetParam()}});
    const unsigned after = _mm_getcsr();
    const int rounding = std::fegetround();
    std::fesetround(FE_TONEAREST);
    _mm_setcsr(before);
    constexpr unsigned kModeBits = ~0x3fu;  // all but the sticky flags
    EXPECT_EQ(modes & kModeBits, after & kModeBits);
    EXPECT_EQ(FE_UPWARD, rounding);
    EXPECT_TRUE(sameBits(plain, strange));
}

INSTANTIATE_TEST_SUITE_P(Integrators, Determinism, ::testing::Values("photon", "path"),
                         [](const auto& info) { return std::string(info.param); });

// A locale whose numbers have a comma, made with localedef when none is installed.
bool useCommaLocale() {
    for (const char* name : {"de_DE.UTF-8", "de_DE.utf8", "fr_FR.UTF-8", "de_DE", "fr_FR"})
        if (std::setlocale(LC_ALL, name) != nullptr) return true;
    const std::filesystem::path folder = ::testing::TempDir() + "pm_locales";
    std::filesystem::create_directories(folder);
    const std::string command =
        "localedef -i de_DE -f UTF-8 '" + (folder / "de_DE.UTF-8").string() + "' >/dev/null 2>&1";
    if (std::system(command.c_str()) != 0) return false;
    setenv("LOCPATH", folder.c_str(), 1);
    return std::setlocale(LC_ALL, "de_DE.UTF-8") != nullptr;
}

TEST(CommaLocale, SettingsStatisticsAndPicture) {
    const BoxHost host;
    const std::vector<float> plain = renderBox(host, {});
    if (!useCommaLocale()) GTEST_SKIP() << "no locale with a decimal comma here";
    ASSERT_STREQ(",", std::localeconv()->decimal_point);
    EXPECT_TRUE(sameBits(plain, renderBox(host, {{"memoryLimitGib", "1.5"}})));
    const PmrRender render = host.makeRender({{"memoryLimitGib", "1.5"}});
    EXPECT_EQ("1.5", textOf([&](char* buffer, std::uint64_t capacity, std::uint64_t* needed) {
                  return api().settingText(render, "memoryLimitGib", buffer, capacity, needed);
              }));
    EXPECT_EQ(PMR_ERROR_ARGUMENT, api().setSettingText(render, "memoryLimitGib", "1,5"));
    EXPECT_EQ(PMR_OK, api().startRender(render));
    EXPECT_EQ(PMR_OK, api().waitRender(render, -1.0));
    const std::string json =
        textOf([&](char* buffer, std::uint64_t capacity, std::uint64_t* needed) {
            return api().renderStatistics(render, buffer, capacity, needed);
        });
    EXPECT_NE(std::string::npos, json.find("\"memoryLimitGib\": 1.5"));
    EXPECT_EQ(PMR_OK, api().destroyRender(render));
    std::setlocale(LC_ALL, "C");
}

}  // namespace

}  // namespace pm::test
