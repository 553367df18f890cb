// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// When a render ends, and which of its passes stand in its error curve.
#include "plugin/session/stop_rule.h"

#include <gtest/gtest.h>

#include <map>
#include <string>

#include "plugin/session/error_curve.h"

namespace pm::plugin {

namespace {

StopRule ruleOf(const std::map<std::string, std::string>& settings) {
    SettingValues values;
    for (const auto& [name, value] : settings) values.setText(name, value);
    return StopRule(values);
}

FrameError errorOf(double noise, double bias) {
    FrameError error;
    error.noise = noise;
    error.bias = bias;
    return error;
}

TEST(StopRule, PassesAreFourOrAsManyAsATargetNeeds) {
    EXPECT_EQ(StopReason::kNone, ruleOf({}).after({3, 1e9, 1e9, {}}));
    EXPECT_EQ(StopReason::kPasses, ruleOf({}).after({4, 1, 1, {}}));
    for (const char* target : {"errorTarget", "timeLimitSeconds"}) {
        EXPECT_EQ(4u, ruleOf({{target, "0"}}).passes());
        EXPECT_FALSE(ruleOf({{target, "0.5"}}).passes());
        EXPECT_EQ(7u, ruleOf({{target, "0.5"}, {"passes", "7"}}).passes());
        EXPECT_EQ(4u, ruleOf({{target, "0.5"}, {"passes", "4"}}).passes());
        EXPECT_EQ(StopReason::kPasses, ruleOf({{target, "1000"}}).after({1000000, 1, 0, {}}));
    }
    SettingValues refused;
    EXPECT_ANY_THROW(refused.setText("passes", "0"));
    refused.setText("errorTarget", "1");
    EXPECT_FALSE(refused.limitsPasses()) << "a value that was refused is not set";
}

TEST(StopRule, ErrorTargetHoldsForNoiseAndBias) {
    const StopRule rule = ruleOf({{"errorTarget", "0.01"}});
    EXPECT_EQ(StopReason::kNone, rule.after({5, 1, 1, {}}));
    EXPECT_EQ(StopReason::kNone, rule.after({5, 1, 1, errorOf(0.02, 0)}));
    EXPECT_EQ(StopReason::kNone, rule.after({5, 1, 1, errorOf(0.009, 0.002)}));
    EXPECT_EQ(StopReason::kErrorTarget, rule.after({5, 1, 1, errorOf(0.009, 0.001)}));
    EXPECT_EQ(StopReason::kNone, rule.after({5, 1, 1, errorOf(0.011, -0.005)}))
        << "bias below 0 is noise";
    EXPECT_EQ(StopReason::kNone, rule.after({1, 1, 1, errorOf(0, 0)}));
    EXPECT_NEAR(20, rule.passesToErrorTarget({5, 1, 1, errorOf(0.04, 0)}).value(), 1e-9);
    EXPECT_NEAR(50, rule.passesToErrorTarget({5, 1, 1, errorOf(0.05, 0.005)}).value(), 1e-9);
    EXPECT_GT(rule.passesToErrorTarget({5, 1, 1, errorOf(0.05, 0.05)}).value(), 5);
    EXPECT_FALSE(ruleOf({}).passesToErrorTarget({5, 1, 1, errorOf(0.05, 0)}));
}

TEST(StopRule, TimeLimitBeginsNoPassThatWouldNotFit) {
    const StopRule rule = ruleOf({{"timeLimitSeconds", "10"}});
    EXPECT_EQ(StopReason::kNone, rule.after({2, 6, 3, {}}));
    EXPECT_EQ(StopReason::kTimeLimit, rule.after({2, 6, 4.5, {}}));
    EXPECT_EQ(StopReason::kTimeLimit, rule.after({1, 60, 60, {}}));
}

// At level 1 four passes make a picture without holes, and eight its error known everywhere.
TEST(StopRule, Level1EndsWithWholePicturesOnly) {
    const std::map<std::string, std::string> both = {
        {"aaLevel", "1"}, {"timeLimitSeconds", "0.001"}, {"errorTarget", "1"}};
    const StopRule rule = ruleOf(both);
    EXPECT_EQ(StopReason::kNone, rule.after({3, 60, 20, errorOf(0, 0)}));
    EXPECT_EQ(StopReason::kTimeLimit, rule.after({4, 60, 20, errorOf(0, 0)}));
    EXPECT_EQ(StopReason::kNone,
              ruleOf({{"aaLevel", "1"}, {"errorTarget", "1"}}).after({7, 60, 20, errorOf(0, 0)}));
    EXPECT_EQ(StopReason::kErrorTarget, rule.after({8, 60, 20, errorOf(0, 0)}));
}

TEST(ErrorCurve, IsBounded) {
    ErrorCurve curve;
    for (std::uint32_t passes = 1; passes <= 1000000; ++passes)
        if (curve.wants(passes)) curve.add({passes, 0, 0, {}});
    EXPECT_GE(curve.points().size(), 40u);
    EXPECT_LE(curve.points().size(), 60u);
    for (std::uint32_t i = 0; i < 16; ++i) EXPECT_EQ(i + 1, curve.points()[i].passes);
    for (std::size_t i = 17; i < curve.points().size(); ++i)
        EXPECT_GE(curve.points()[i].passes, 1.41 * curve.points()[i - 1].passes);
}

}  // namespace

}  // namespace pm::plugin
