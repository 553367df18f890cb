// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// What is counted as specks, on pictures whose noise is known.
#include "tests/bench/specks/specks.h"

#include <gtest/gtest.h>

#include <cstddef>

namespace pm::bench {
namespace {

constexpr int kWidth = 40, kHeight = 25, kPictures = 8;

// Even light of 1 that is off by `noise`, every second picture to the other side.
std::vector<Values> evenPictures(double noise) {
    std::vector<Values> pictures;
    for (int i = 0; i < kPictures; ++i)
        pictures.emplace_back(3 * kWidth * kHeight, 1 + (i % 2 == 0 ? noise : -noise));
    return pictures;
}

double& at(Values& picture, int x, int y, int channel) {
    return picture[static_cast<std::size_t>(3 * (y * kWidth + x) + channel)];
}

TEST(Specks, EvenNoiseHasNone) {
    const Specks specks = findSpecks(evenPictures(0.1), kWidth, kHeight);
    EXPECT_NEAR(specks.worstRatio, 1, 1e-9);
    EXPECT_EQ(specks.count, 0);
    EXPECT_NEAR(specks.judged, 1, 1e-9);
}

// A firefly in one of the pictures: its standard deviation over that of what is beside it.
TEST(Specks, AFireflyIsFound) {
    std::vector<Values> pictures = evenPictures(0.01);
    for (int c = 0; c < 3; ++c) at(pictures[3], 30, 12, c) = 4;
    const Specks specks = findSpecks(pictures, kWidth, kHeight);
    EXPECT_EQ(specks.count, 1);
    EXPECT_EQ(specks.x, 30);
    EXPECT_EQ(specks.y, 12);
    EXPECT_GT(specks.worstRatio, 90);
    EXPECT_LT(specks.worstRatio, 110);
}

// Brighter by more than a factor of 2, it has no pixel to be judged by.
TEST(Specks, WhatIsUnlikeIsNotJudged) {
    std::vector<Values> pictures = evenPictures(0.01);
    for (Values& picture : pictures)
        for (int c = 0; c < 3; ++c) at(picture, 5, 5, c) *= 3;
    const Specks specks = findSpecks(pictures, kWidth, kHeight);
    EXPECT_EQ(specks.count, 0);
    EXPECT_NEAR(specks.judged, 1 - 1.0 / (kWidth * kHeight), 1e-9);
}

// (a - b)^2 / (2 (m^2 + .01)) over 1000 pixels of which one is the worst .1 %.
TEST(Specks, PairsTellTheErrorAndItsWorstPart) {
    Values a(3 * kWidth * kHeight, 1.1), b(3 * kWidth * kHeight, 0.9);
    const double even = 0.04 / 2 / 1.01;
    EXPECT_NEAR(errorOfPair(a, b).mean, even, 1e-12);
    EXPECT_NEAR(errorOfPair(a, b).ofWorst, 1e-3, 1e-12);
    for (int c = 0; c < 3; ++c) at(a, 7, 7, c) = 3.1;
    const double worst = 2.2 * 2.2 / 2 / 4.01;
    const PairError pair = errorOfPair(a, b);
    EXPECT_NEAR(pair.mean, (999 * even + worst) / 1000, 1e-9);
    EXPECT_NEAR(pair.ofWorst, worst / (999 * even + worst), 1e-9);
}

}  // namespace
}  // namespace pm::bench
