// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// The measures themselves: a test by a measure that is never "too far" would hold nothing.
#include <gtest/gtest.h>

#include <limits>

#include "tests/scene/picture_measures.h"

namespace pm::host::test {
namespace {

Picture flat(std::int32_t side, float value, float error) {
    const auto count = static_cast<std::size_t>(side * side);
    Picture picture{side, side, {0, 0, side, side}, {}, {}};
    for (const char* name : {"R", "G", "B"}) {
        picture.channels.push_back({name, true, std::vector<float>(count, value)});
    }
    picture.channels.push_back({"A", true, std::vector<float>(count, 1.0f)});
    for (const char* name : {"stderr.X", "stderr.Y", "stderr.Z"}) {
        picture.channels.push_back({name, false, std::vector<float>(count, error)});
    }
    return picture;
}

TEST(Measures, NanAndInfinityAreFound) {
    Picture picture = flat(4, 1.0f, 0.1f);
    EXPECT_TRUE(allFinite(picture));
    picture.channels[4].values[7] = std::numeric_limits<float>::quiet_NaN();
    const auto result = allFinite(picture);
    EXPECT_FALSE(result);
    EXPECT_NE(std::string(result.message()).find("stderr.X is nan at 3,1"), std::string::npos);
    picture.channels[4].values[7] = std::numeric_limits<float>::infinity();
    EXPECT_FALSE(allFinite(picture));
    EXPECT_FALSE(allFinite(Picture{}));
}

TEST(Measures, BlackIsNotLit) {
    Picture picture = flat(4, 0.0f, 0.0f);
    EXPECT_FALSE(isLit(picture));
    picture.channels[1].values[3] = 0.5f;
    EXPECT_TRUE(isLit(picture));
    EXPECT_FALSE(isLit(picture, 0.5));
}

TEST(Measures, ErrorAgainstAReference) {
    const Picture reference = flat(10, 0.3f, 0.0f);
    const Picture picture = flat(10, 0.33f, 0.02f);
    const ReferenceError error = errorAgainst(reference, picture);
    EXPECT_NEAR(error.relMse, 0.0009 / 0.1, 1e-6);
    EXPECT_NEAR(error.predicted, 0.0004 / 0.1, 1e-6);
    EXPECT_NEAR(error.meanRatio, 1.1, 1e-6);
}

TEST(Measures, TheWorstPixelsAreDropped) {
    const Picture reference = flat(10, 0.3f, 0.0f);
    Picture picture = flat(10, 0.3f, 0.0f);
    picture.channels[0].values[42] = 100.0f;
    EXPECT_GT(errorAgainst(reference, picture).relMse, 100.0);
    EXPECT_EQ(errorAgainst(reference, picture, 0.01).relMse, 0.0);
}

TEST(Measures, LampsAndTheirSurroundingsDoNotCountInTheMean) {
    Picture reference = flat(10, 0.3f, 0.0f);
    Picture picture = flat(10, 0.3f, 0.0f);
    reference.channels[0].values[0] = 100.0f;
    picture.channels[1].values[22] = 50.0f;
    EXPECT_NEAR(errorAgainst(reference, picture).meanRatio, 1.0, 1e-6);
    picture.channels[1].values[23] = 0.6f;
    EXPECT_GT(errorAgainst(reference, picture).meanRatio, 1.003);
}

TEST(Measures, HalvedIsTheMeanOfFour) {
    Picture picture = flat(4, 0.0f, 0.0f);
    for (std::size_t i = 0; i < 16; ++i) picture.channels[0].values[i] = static_cast<float>(i);
    const Picture half = halved(picture);
    EXPECT_EQ(half.width, 2);
    EXPECT_EQ(half.dataWindow, (PixelRect{0, 0, 2, 2}));
    EXPECT_EQ(half.channels[0].values, (std::vector<float>{2.5f, 4.5f, 10.5f, 12.5f}));
}

}  // namespace
}  // namespace pm::host::test
