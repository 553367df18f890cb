// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/pictures/compare.h"

#include <cstdint>
#include <limits>
#include <optional>

#include "tests/colour/scratch.h"
#include "tests/colour/test_pictures.h"

namespace pm::host::test {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

Picture constantPicture(float value) {
    Picture picture = gradientPicture(4, 2);
    for (Channel& channel : picture.channels) {
        channel.values.assign(channel.values.size(), value);
    }
    return picture;
}

TEST(RelMse, IsTheFormula) {
    // (0.6 - 0.5)^2 / (0.5^2 + 0.01) everywhere.
    const auto report = compareRelMse(constantPicture(0.5f), constantPicture(0.6f));
    ASSERT_TRUE(report.relMse);
    EXPECT_NEAR(*report.relMse, 0.01 / 0.26, 1e-7);
    // One of 24 values off by 1 where the reference is 0: 1 / 0.01 / 24.
    Picture picture = constantPicture(0.0f);
    picture.channels[1].values[5] = 1.0f;
    EXPECT_NEAR(*compareRelMse(constantPicture(0.0f), picture).relMse, 100.0 / 24.0, 1e-9);
    EXPECT_EQ(*compareRelMse(picture, picture).relMse, 0.0);
}

TEST(RelMse, AlphaAndOtherChannelsDoNotCount) {
    Picture picture = constantPicture(0.5f);
    picture.channels[3].values.assign(8, 77.0f);
    picture.channels.push_back({"Z", false, std::vector<float>(8, 1e10f)});
    EXPECT_EQ(*compareRelMse(constantPicture(0.5f), picture).relMse, 0.0);
}

TEST(RelMse, BadValuesAreFoundFirst) {
    Picture picture = constantPicture(0.5f);
    picture.channels[0].values[0] = kNan;
    picture.channels[2].values[7] = std::numeric_limits<float>::infinity();
    auto report = compareRelMse(constantPicture(0.5f), picture);
    EXPECT_FALSE(report.relMse);
    EXPECT_EQ(report.badInPicture, 2);
    EXPECT_EQ(report.badInReference, 0);
    report = compareRelMse(picture, constantPicture(0.5f));
    EXPECT_FALSE(report.relMse);
    EXPECT_EQ(report.badInReference, 2);
}

TEST(RelMse, ACropIsHeldAgainstTheSamePixels) {
    const Picture whole = gradientPicture(8, 6);
    Picture crop = gradientPicture(8, 6, {2, 1, 5, 4});
    for (std::size_t c = 0; c < 4; ++c) {
        for (std::size_t y = 0; y < 3; ++y) {
            for (std::size_t x = 0; x < 3; ++x) {
                crop.channels[c].values[y * 3 + x] = whole.channels[c].values[(y + 1) * 8 + x + 2];
            }
        }
    }
    EXPECT_EQ(*compareRelMse(whole, crop).relMse, 0.0);
    crop.dataWindow = {3, 1, 6, 4};
    EXPECT_GT(*compareRelMse(whole, crop).relMse, 0.0);
}

TEST(RelMse, UnlikePicturesAreRefused) {
    const Picture picture = gradientPicture(8, 6);
    EXPECT_TRUE(refusesWith(refusal([&] { compareRelMse(gradientPicture(8, 7), picture); }), 3,
                            {"8x7", "8x6"}));
    const Picture crop = gradientPicture(8, 6, {1, 0, 8, 6});
    EXPECT_TRUE(refusesWith(refusal([&] { compareRelMse(crop, picture); }), 3, {"data window"}));
    Picture grey = gradientPicture(8, 6);
    grey.channels.erase(grey.channels.begin() + 1);
    EXPECT_TRUE(
        refusesWith(refusal([&] { compareRelMse(grey, picture); }), 3, {"reference", "channel G"}));
    EXPECT_TRUE(
        refusesWith(refusal([&] { compareRelMse(picture, grey); }), 3, {"picture", "channel G"}));
}

// Of the unit of the pictures: 2^-13 of both at a scale of 13 stops.
TEST(RelMse, errorScaleIsOfTheUnit) {
    const float dim = 1.0f / 8192;
    const auto relMse = [&](float factor, std::int32_t scale) {
        return *compareRelMse(constantPicture(0.5f * factor), constantPicture(0.6f * factor),
                              errorOffset(scale))
                    .relMse;
    };
    EXPECT_NEAR(relMse(dim, 13), relMse(1.0f, 0), 1e-9);
    EXPECT_LT(relMse(dim, 0), 1e-6);
    auto picture = constantPicture(0.5f);
    EXPECT_EQ(errorScaleOf(picture), std::nullopt);
    picture.attributes["pm:errorScale"] = std::string("13");
    EXPECT_EQ(errorScaleOf(picture), std::nullopt);
    for (const std::int32_t out : {-41, 41}) {
        picture.attributes["pm:errorScale"] = out;
        EXPECT_EQ(errorScaleOf(picture), std::nullopt);
    }
    picture.attributes["pm:errorScale"] = std::int32_t{-7};
    EXPECT_EQ(errorScaleOf(picture), -7);
    EXPECT_EQ(errorScaleText(0), "");
    EXPECT_EQ(errorScaleText(-7), " at an error scale of -7 stops");
}

}  // namespace
}  // namespace pm::host::test
