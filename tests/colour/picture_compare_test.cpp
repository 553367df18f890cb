// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "tests/colour/picture_compare.h"

#include <cstdlib>
#include <limits>

#include "tests/colour/test_pictures.h"

namespace pm::host::test {
namespace {

TEST(SamePicture, FailsOnNanEvenWhereBothHaveIt) {
    Picture picture = gradientPicture(8, 6);
    EXPECT_TRUE(samePicture(picture, picture));
    picture.channels[1].values[3] = std::numeric_limits<float>::quiet_NaN();
    const auto result = samePicture(picture, picture, {.absolute = 1e30});
    EXPECT_FALSE(result);
    EXPECT_NE(std::string(result.message()).find("1 in G"), std::string::npos) << result.message();
    EXPECT_FALSE(samePicture(gradientPicture(8, 6), picture, {.absolute = 1e30}));
}

TEST(SamePicture, ComparesWindowsChannelsAndAttributes) {
    const Picture golden = gradientPicture(8, 6);
    EXPECT_FALSE(samePicture(golden, gradientPicture(8, 6, {0, 0, 8, 5}), {.absolute = 9}));
    EXPECT_FALSE(samePicture(golden, gradientPicture(8, 7, {0, 0, 8, 6}), {.absolute = 9}));
    Picture picture = golden;
    picture.channels[2].name = "direct.B";
    EXPECT_FALSE(samePicture(golden, picture, {.absolute = 9}));
    picture = golden;
    picture.attributes["pm:seed"] = 2;
    EXPECT_FALSE(samePicture(golden, picture));
    EXPECT_TRUE(samePicture(golden, picture, {.freeAttributes = {"pm:seed"}}));
}

TEST(SamePicture, KnowsItsTolerances) {
    const Picture golden = gradientPicture(8, 6);
    Picture picture = golden;
    picture.channels[1].values[9] += 0.01f;
    EXPECT_FALSE(samePicture(golden, picture));
    EXPECT_FALSE(samePicture(golden, picture, {.absolute = 0.009}));
    EXPECT_TRUE(samePicture(golden, picture, {.absolute = 0.011}));
    Picture errors = golden;
    for (Channel& channel : errors.channels) channel.values.assign(48, 0.003f);
    EXPECT_TRUE(samePicture(golden, picture, {.sigmas = 4, .goldenErrors = &errors}));
    EXPECT_FALSE(samePicture(golden, picture, {.sigmas = 3, .goldenErrors = &errors}));
    EXPECT_TRUE(samePicture(golden, picture,
                            {.sigmas = 3, .goldenErrors = &errors, .pictureErrors = &errors}));
}

TEST(SamePicture, ClearsTheEnvironment) {
    for (const char* name : {"OCIO", "OCIO_ACTIVE_VIEWS", "OPENIMAGEIO_OPTIONS", "LC_ALL"}) {
        setenv(name, "x", 1);
    }
    const Picture golden = gradientPicture(2, 2);
    EXPECT_TRUE(samePicture(golden, golden));
    for (const char* name : {"OCIO", "OCIO_ACTIVE_VIEWS", "OPENIMAGEIO_OPTIONS", "LC_ALL"}) {
        EXPECT_EQ(getenv(name), nullptr) << name;
    }
}

}  // namespace
}  // namespace pm::host::test
