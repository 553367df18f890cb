// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// The sky of --sun: the numbers of the paper it comes from, and where the sun stands.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "host_shim/sky/daylight.h"
#include "host_shim/sky/sky_light.h"

namespace pm::host::test {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

// At the zenith Perez' distribution is 1: what is left are the paper's fits, here by hand for a sun
// at the zenith, where its polynomials have one term.
TEST(Sky, ZenithIsAsThePaperHasIt) {
    for (const double t : {2.0, 3.0, 6.0}) {
        const Xyz zenith = Daylight(90 * kDegree, t).sky(0, 0);
        const double chi = (4.0 / 9 - t / 120) * std::numbers::pi;
        EXPECT_NEAR(zenith[1], (4.0453 * t - 4.9710) * std::tan(chi) - 0.2155 * t + 2.4192, 1e-9);
        const double sum = zenith[0] + zenith[1] + zenith[2];
        EXPECT_NEAR(zenith[0] / sum, 0.00394 * t + 0.25886, 1e-9);
        EXPECT_NEAR(zenith[1] / sum, 0.00516 * t + 0.26688, 1e-9);
    }
}

// Brighter around the sun than away from it, whiter at the horizon, bluer opposite the sun.
TEST(Sky, LooksLikeOne) {
    const Daylight day(40 * kDegree, 3);
    const double sunZenith = 50 * kDegree;
    EXPECT_GT(day.sky(sunZenith, 5 * kDegree)[1], 2 * day.sky(sunZenith, 90 * kDegree)[1]);
    const auto blueness = [](const Xyz& xyz) {
        const auto rgb = toRec709(xyz);
        return rgb[2] / rgb[0];
    };
    EXPECT_GT(blueness(day.sky(40 * kDegree, 90 * kDegree)), 2.0);
    EXPECT_LT(blueness(day.sky(89 * kDegree, 90 * kDegree)),
              blueness(day.sky(40 * kDegree, 90 * kDegree)));
}

// 133.1 klx are measured above the atmosphere (ASTM E490); a black body is within 6 %.
TEST(Sky, SunIsAsBrightAsItIs) {
    EXPECT_NEAR(Daylight::sunAbove()[1], 133.1, 0.06 * 133.1);
    const Xyz high = Daylight(60 * kDegree, 3).sun(), low = Daylight(5 * kDegree, 3).sun();
    EXPECT_GT(high[1], 75);
    EXPECT_LT(high[1], 110);
    EXPECT_LT(low[1], 20);
    EXPECT_GT(toRec709(low)[0], 3 * toRec709(low)[2]) << "a low sun is red";
}

TEST(Sky, PictureIsBrightestAtTheSunsPlace) {
    const SkyData sky{135, 40, 3, 1, false};
    const Picture picture = skyPicture(sky, 256);
    const auto& green = picture.channels[1].values;
    const auto at = std::max_element(green.begin(), green.begin() + 256 * 60) - green.begin();
    const auto x = static_cast<double>(at % 256), y = static_cast<double>(at / 256);
    EXPECT_NEAR(x, 256 * (0.5 + 135.0 / 360), 2);  // right of the middle, which is -z
    EXPECT_NEAR(y, 128 * 50.0 / 180, 2);
    const LightData sun = sunLight(sky);
    const double side = std::sin(135 * kDegree) * std::cos(40 * kDegree);
    EXPECT_NEAR(sun.transform[2], side, 1e-12);
    EXPECT_NEAR(sun.transform[6], std::sin(40 * kDegree), 1e-12);
    EXPECT_NEAR(sun.transform[10], side, 1e-12);
    EXPECT_GT(determinant(sun.transform), 0.999);
    for (const Channel& channel : picture.channels)
        for (const float value : channel.values) ASSERT_TRUE(value >= 0 && std::isfinite(value));
}

// Where z is up, north is +y and east stays +x.
TEST(Sky, TurnsWithTheSceneThatStandsOnZ) {
    SkyData sky{0, 30, 3, 1, true};
    const LightData north = sunLight(sky);
    EXPECT_NEAR(north.transform[6], std::cos(30 * kDegree), 1e-12);
    EXPECT_NEAR(north.transform[10], std::sin(30 * kDegree), 1e-12);
    sky.azimuth = 90;
    EXPECT_NEAR(sunLight(sky).transform[2], std::cos(30 * kDegree), 1e-12);
}

}  // namespace
}  // namespace pm::host::test
