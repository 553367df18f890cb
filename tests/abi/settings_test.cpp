// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// The enumerations, and settings by integer, number and text.
#include <cmath>
#include <limits>
#include <set>

#include "tests/abi/host.h"

namespace pm::test {

namespace {

std::string get(PmrRender render, const char* name) {
    return textOf([&](char* buffer, std::uint64_t capacity, std::uint64_t* needed) {
        return api().settingText(render, name, buffer, capacity, needed);
    });
}

TEST(Settings, EnumerationIsWhole) {
    const BoxHost host;
    PmrRender render = nullptr;
    ASSERT_EQ(PMR_OK, api().createRender(host.scene(), nullptr, &render));
    std::set<std::string> names;
    for (std::uint32_t i = 0; i < api().settingCount(); ++i) {
        PmrSettingInfo info = PMR_INIT(PmrSettingInfo);
        ASSERT_EQ(PMR_OK, api().settingInfo(i, &info));
        EXPECT_TRUE(names.insert(info.name).second) << info.name;
        for (const char* text : {info.help, info.cost}) EXPECT_GT(std::string(text).size(), 3u);
        EXPECT_LE(info.minimum, info.maximum);
        EXPECT_EQ(info.type == PMR_SETTING_CHOICE, *info.choices != 0);
        // Defaults are what a new render has, and may be set.
        EXPECT_EQ(info.defaultText, get(render, info.name));
        EXPECT_EQ(PMR_OK, api().setSettingText(render, info.name, info.defaultText));
        if (info.type == PMR_SETTING_INTEGER && info.maximum < 1e15) {
            const auto above = static_cast<std::int64_t>(info.maximum) + 1;
            const auto below = static_cast<std::int64_t>(info.minimum) - 1;
            EXPECT_EQ(PMR_ERROR_ARGUMENT, api().setSettingInteger(render, info.name, above));
            EXPECT_EQ(PMR_ERROR_ARGUMENT, api().setSettingInteger(render, info.name, below));
            EXPECT_EQ(PMR_OK, api().setSettingInteger(render, info.name, above - 1));
            EXPECT_EQ(PMR_OK, api().setSettingInteger(render, info.name, below + 1));
        }
    }
    for (const char* name :
         {"width",       "height",           "crop",         "threads",     "bucketSize",
          "bucketOrder", "aaLevel",          "integrator",   "photons",     "estimatePhotons",
          "gatherRays",  "passes",           "seed",         "layers",      "memoryLimitGib",
          "errorTarget", "timeLimitSeconds", "plan",         "buckets",     "part",
          "checkpoint",  "resume",           "hostIdentity", "aaLevelMost", "aaThreshold",
          "filter",      "hostNote",         "errorScale"})
        EXPECT_EQ(1u, names.count(name)) << name;
    EXPECT_EQ(PMR_OK, api().destroyRender(render));
}

TEST(Settings, RefusalsSayWhatIsAllowed) {
    const BoxHost host;
    const PmrRender render = host.makeRender({{"passes", "7"}});
    EXPECT_EQ(PMR_ERROR_ARGUMENT, api().setSettingInteger(render, "passes", 0));
    EXPECT_EQ("setting passes is 0; it must be 1 to 1000000", host.lastError());
    EXPECT_EQ("7", get(render, "passes"));  // the value before stays
    EXPECT_EQ(PMR_ERROR_ARGUMENT, api().setSettingText(render, "bucketSize", "30"));
    EXPECT_EQ("setting bucketSize is 30; it must be 0 or a multiple of 8 from 8 to 1024",
              host.lastError());
    EXPECT_EQ(PMR_ERROR_ARGUMENT, api().setSettingText(render, "bucketOrder", "peano"));
    EXPECT_EQ(
        "setting bucketOrder is 'peano'; it must be one of "
        "hilbert,row,column,diagonal,spiral,random,correlated",
        host.lastError());
    EXPECT_EQ(PMR_ERROR_ARGUMENT, api().setSettingText(render, "layers", "N,bokeh"));
    EXPECT_NE(std::string::npos, host.lastError().find("'bokeh'"));
    for (const char* text : {"", " 4", "4 ", "4.0", "4,0", "0x4", "four", "99999999999999999999"})
        EXPECT_EQ(PMR_ERROR_ARGUMENT, api().setSettingText(render, "passes", text)) << text;
    for (const char* text : {"1,2,3", "1,2,3,4,5", "5,5,5,9", "0,0,-3,4", "a,b,c,d", "0,0,1e3,4",
                             "0,0,999999999,4", "0,0,4,4,"})
        EXPECT_EQ(PMR_ERROR_ARGUMENT, api().setSettingText(render, "crop", text)) << text;
    EXPECT_EQ(PMR_OK, api().setSettingText(render, "crop", "-8,0,4,4"));
    EXPECT_EQ(PMR_OK, api().destroyRender(render));
}

TEST(Settings, NumbersAndIntegers) {
    const BoxHost host;
    const PmrRender render = host.makeRender({});
    const double nan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_EQ(PMR_OK, api().setSettingNumber(render, "passes", 3.0));
    EXPECT_EQ("3", get(render, "passes"));
    for (const double bad : {3.5, nan, HUGE_VAL, -HUGE_VAL, 1e300})
        EXPECT_EQ(PMR_ERROR_ARGUMENT, api().setSettingNumber(render, "passes", bad));
    for (const double bad : {-1.0, nan, HUGE_VAL})
        EXPECT_EQ(PMR_ERROR_ARGUMENT, api().setSettingNumber(render, "memoryLimitGib", bad));
    EXPECT_EQ(PMR_OK, api().setSettingInteger(render, "memoryLimitGib", 3));
    EXPECT_EQ(PMR_OK, api().setSettingNumber(render, "memoryLimitGib", 0.25));
    EXPECT_EQ("0.25", get(render, "memoryLimitGib"));
    EXPECT_EQ(PMR_ERROR_ARGUMENT, api().setSettingInteger(render, "integrator", 1));
    EXPECT_EQ(PMR_OK, api().setSettingInteger(render, "seed", INT64_MAX));
    EXPECT_EQ("9223372036854775807", get(render, "seed"));
    EXPECT_EQ(PMR_OK, api().destroyRender(render));
}

// Whole stops by number or text, or auto.
TEST(Settings, ErrorScale) {
    const BoxHost host;
    const PmrRender render = host.makeRender({});
    EXPECT_EQ("auto", get(render, "errorScale"));
    EXPECT_EQ(PMR_OK, api().setSettingInteger(render, "errorScale", -13));
    EXPECT_EQ("-13", get(render, "errorScale"));
    EXPECT_EQ(PMR_OK, api().setSettingText(render, "errorScale", "40"));
    for (const char* text : {"41", "-41", "1.5", "", "Auto", " 3", "+3"})
        EXPECT_EQ(PMR_ERROR_ARGUMENT, api().setSettingText(render, "errorScale", text)) << text;
    EXPECT_EQ(PMR_ERROR_ARGUMENT, api().setSettingInteger(render, "errorScale", 41));
    EXPECT_EQ("setting errorScale is '41'; it must be auto, or whole stops from -40 to 40",
              host.lastError());
    EXPECT_EQ("40", get(render, "errorScale"));
    EXPECT_EQ(PMR_OK, api().setSettingText(render, "errorScale", "auto"));
    EXPECT_EQ(PMR_OK, api().destroyRender(render));
}

TEST(Settings, MemoryLeftIsTheLimitLessWhatIsHeld) {
    constexpr std::uint64_t kGib = std::uint64_t{1} << 30;
    EXPECT_GT(api().memoryLeft(0.0), 0u);
    EXPECT_EQ(api().memoryLeft(1e-6), 0u);
    const std::uint64_t left = api().memoryLeft(1.0), more = api().memoryLeft(2.0);
    EXPECT_LT(left, kGib);
    EXPECT_GT(more, kGib / 2);
    // What is no limit stands for none.
    for (const double bad : {-1.0, std::numeric_limits<double>::quiet_NaN(), HUGE_VAL})
        EXPECT_GT(api().memoryLeft(bad), 0u);
}

TEST(Settings, ExplainBeforeStart) {
    const BoxHost host;
    const PmrRender render = host.makeRender({});
    EXPECT_GT(textOf([&](char* buffer, std::uint64_t capacity, std::uint64_t* needed) {
                  return api().explainRender(render, buffer, capacity, needed);
              }).size(),
              20u);
    EXPECT_EQ(PMR_OK, api().destroyRender(render));
}

}  // namespace

}  // namespace pm::test
