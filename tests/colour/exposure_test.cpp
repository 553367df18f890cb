// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Exposure as a camera would choose it, and what it does to a display picture.
#include "host_shim/colour/exposure.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "host_shim/colour/colour_pipeline.h"

namespace pm::host::test {
namespace {

constexpr std::array<double, 3> kThirds{0.25, 0.5, 0.25};

// Greys of these radiances; of the second list lamps.
Picture greys(const std::vector<float>& surfaces, const std::vector<float>& lamps = {}) {
    Picture picture;
    picture.width = static_cast<std::int32_t>(surfaces.size() + lamps.size());
    picture.height = 1;
    picture.dataWindow = {0, 0, picture.width, 1};
    for (const char* name : {"R", "G", "B", "emission.R", "emission.G", "emission.B", "A"}) {
        Channel channel{name, true, {}};
        const bool isEmission = channel.name.starts_with("emission");
        const bool isCoverage = channel.name == "A";
        for (const float value : surfaces)
            channel.values.push_back(isCoverage ? 1.0f : isEmission ? 0.0f : value);
        for (const float value : lamps) channel.values.push_back(isCoverage ? 1.0f : value);
        picture.channels.push_back(std::move(channel));
    }
    return picture;
}

double stopsOf(const std::vector<float>& surfaces, const std::vector<float>& lamps = {}) {
    return measuredExposureStops(greys(surfaces, lamps), kThirds);
}

TEST(Exposure, evenSurfacesBecomeMiddleGrey) {
    EXPECT_DOUBLE_EQ(stopsOf({0.18f, 0.18f}), 0);
    EXPECT_DOUBLE_EQ(stopsOf({0.09f}), 1);
    EXPECT_DOUBLE_EQ(stopsOf({1.44f, 1.44f}), -3);
    // The mean is one of logarithms: a quarter and four times as bright.
    EXPECT_DOUBLE_EQ(stopsOf({0.045f, 0.72f}), 0);
    EXPECT_DOUBLE_EQ(stopsOf({0.1f}), 0.85) << "log2(1.8) to 1/100";
}

TEST(Exposure, lampsDontRule) {
    EXPECT_DOUBLE_EQ(stopsOf({0.09f, 0.09f}, {1e6f}), 1);
    std::vector<float> walls(96, 0.09f);
    EXPECT_DOUBLE_EQ(stopsOf(walls, {1e4f, 1e4f, 1e4f}), 1);
    // Where nearly nothing but lamps is seen, they are the picture.
    EXPECT_NEAR(stopsOf({0.36f}, std::vector<float>(99, 0.36f)), -1, 1e-12);
}

// A spot on a twentieth of a dark picture: the mean alone would make it 13 stops too bright.
TEST(Exposure, highlightsStayWithinTwice) {
    std::vector<float> picture(95, 0.0f);
    picture.resize(100, 1.0f);
    EXPECT_DOUBLE_EQ(stopsOf(picture), 1);
    picture.assign(95, 1e-5f);
    picture.resize(100, 8.0f);
    EXPECT_DOUBLE_EQ(stopsOf(picture), -2);
    // Fewer than one in fifty may be brighter.
    picture.assign(99, 0.18f);
    picture.push_back(1e5f);
    EXPECT_NEAR(stopsOf(picture), -0.19, 0.011);
}

TEST(Exposure, staysWithinItsLimits) {
    EXPECT_EQ(stopsOf({0.0f, 0.0f}), 0) << "nothing to expose for";
    EXPECT_EQ(measuredExposureStops(Picture{}, kThirds), 0);
    EXPECT_EQ(stopsOf({1e-20f}), kMostExposureStops);
    EXPECT_EQ(stopsOf({1e20f}), -kMostExposureStops);
    constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
    EXPECT_TRUE(std::isfinite(stopsOf({kNan, 0.18f, std::numeric_limits<float>::infinity()})));
    Picture uncovered = greys({5.0f, 0.18f});
    uncovered.channels.back().values[0] = 0;
    EXPECT_DOUBLE_EQ(measuredExposureStops(uncovered, kThirds), 0) << "what is not covered";
}

TEST(Exposure, litShareCountsSurfacesThatCanBeShown) {
    EXPECT_DOUBLE_EQ(litShare(greys({0.0f, 0.0f, 0.0f, 1e-6f}, {9.0f}), kThirds), 0.25);
    EXPECT_DOUBLE_EQ(litShare(greys({1e-9f, 0.0f}, {9.0f}), kThirds), 0);
    EXPECT_DOUBLE_EQ(litShare(greys({}, {9.0f}), kThirds), 1);
}

TEST(Exposure, darkShareIsOfWhatStaysBlack) {
    EXPECT_DOUBLE_EQ(darkShare(greys({1.0f, 1.0f, 1e-7f, 0.0f}, {9.0f}), kThirds), 0.5);
    // However dim all is, exposure finds it.
    EXPECT_DOUBLE_EQ(darkShare(greys({1e-5f, 2e-5f, 1e-5f}), kThirds), 0);
    std::vector<float> spot(96, 1e-6f);
    spot.resize(100, 5.0f);
    EXPECT_DOUBLE_EQ(darkShare(greys(spot), kThirds), 0.96);
    EXPECT_DOUBLE_EQ(darkShare(greys({1e-9f, 0.0f}, {9.0f}), kThirds), 1);
    EXPECT_DOUBLE_EQ(darkShare(greys({}, {9.0f}), kThirds), 0);
}

// What reflects nothing is as black in any light.
TEST(Exposure, blackSurfacesAreNotMetered) {
    Picture picture = greys({0.18f, 0.18f, 0.0f, 0.0f});
    EXPECT_GT(measuredExposureStops(picture, kThirds), 1);
    for (const char* name : {"albedo.R", "albedo.G", "albedo.B"})
        picture.channels.push_back({name, true, {0.5f, 0.5f, 0.0f, 0.0f}});
    EXPECT_EQ(measuredExposureStops(picture, kThirds), 0);
    EXPECT_EQ(darkShare(picture, kThirds), 0);
    EXPECT_EQ(litShare(picture, kThirds), 1);
}

// Where nothing reflects more, little is enough to be metered; nothing is not.
TEST(Exposure, dimSurfacesAreMeteredAmongThemselves) {
    const auto withAlbedo = [](std::vector<float> radiances, const std::vector<float>& albedo) {
        Picture picture = greys(radiances);
        for (const char* name : {"albedo.R", "albedo.G", "albedo.B"})
            picture.channels.push_back({name, true, albedo});
        return picture;
    };
    const Picture dim = withAlbedo({0.09f, 0.09f, 0.0f, 0.0f}, {1e-5f, 1e-5f, 0.0f, 0.0f});
    EXPECT_DOUBLE_EQ(measuredExposureStops(dim, kThirds), 1);
    EXPECT_DOUBLE_EQ(litShare(dim, kThirds), 1);
    EXPECT_DOUBLE_EQ(blackShare(dim, kThirds), 0.5);
    EXPECT_DOUBLE_EQ(litShare(withAlbedo({0.0f, 0.0f}, {1e-5f, 0.0f}), kThirds), 0);
    EXPECT_DOUBLE_EQ(litShare(withAlbedo({0.0f, 0.0f}, {0.0f, 0.0f}), kThirds), 1);
    EXPECT_DOUBLE_EQ(blackShare(greys({0.0f}), kThirds), 0) << "not known";
    EXPECT_DOUBLE_EQ(blackShare(greys({}, {9.0f}), kThirds), 0);
}

TEST(Exposure, multipliesBeforeTheView) {
    for (const char* view : {"", "untone-mapped"}) {
        const ColourPipeline colour({.view = view});
        const DisplayTransform plain = colour.displayTransform();
        for (const double stops : {-2.0, 1.0, 3.0}) {
            DisplayTransform exposed = colour.displayTransform();
            exposed.setExposureStops(stops);
            std::vector<float> given{0.05f, 0.1f, 0.02f}, scaled = given;
            for (float& value : scaled) value *= std::exp2(static_cast<float>(stops));
            exposed.apply(given, 3);
            plain.apply(scaled, 3);
            EXPECT_EQ(given, scaled) << stops;
        }
    }
}

TEST(Exposure, isToldAsItIsGiven) {
    EXPECT_EQ(exposureText({2.5, Exposure::From::kMeasured}), "2.5 (auto)");
    EXPECT_EQ(exposureText({-1, Exposure::From::kGiven}), "-1");
    EXPECT_EQ(exposureText({}), "0");
}

}  // namespace
}  // namespace pm::host::test
