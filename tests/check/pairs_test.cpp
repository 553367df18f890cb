// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Renders that share their noise: who they are, and by how much they may be off.
#include "host_shim/check/pairs.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace pm::host {
namespace {

constexpr PixelRect kWindow{-4, 0, 20, 12};  // 3 x 2 regions of 8, the lower ones 4 high

// Light 1 with noise of a fifth; other noise of a share on it.
Picture render(unsigned seed, float ofOther = 0, unsigned other = 0) {
    std::mt19937 random(seed), another(other);
    std::normal_distribution<float> noise(0.0f, 0.2f);
    Picture picture{24, 12, kWindow, {}, {}};
    for (const char* name : {"R", "G", "B"}) {
        Channel& channel = picture.channels.emplace_back(Channel{name, true, {}});
        for (int i = 0; i < 24 * 12; ++i)
            channel.values.push_back(1 + noise(random) + ofOther * noise(another));
    }
    return picture;
}

Picture noiseOfSeeds(unsigned first) {
    std::vector<Picture> pictures;
    for (unsigned seed = first; seed < first + 16; ++seed) pictures.push_back(render(seed));
    std::vector<const Picture*> all;
    for (const Picture& picture : pictures) all.push_back(&picture);
    return pixelNoiseOf(all);
}

void brighten(Picture& picture, float factor) {
    for (Channel& channel : picture.channels)
        for (float& value : channel.values) value *= factor;
}

TEST(Pairs, NoiseIsOfOneRender) {
    const Picture noise = noiseOfSeeds(100);
    const Channel &mean = *noise.find("mean.G"), &deviation = *noise.find("deviation.G");
    double means = 0, variances = 0;
    for (std::size_t i = 0; i < mean.values.size(); ++i) {
        means += mean.values[i];
        variances += std::pow(deviation.values[i], 2);
    }
    const double count = static_cast<double>(mean.values.size());
    EXPECT_NEAR(means / count, 1, 0.02);
    EXPECT_NEAR(variances / count, 0.04, 0.004);
}

TEST(Pairs, OneSeedSharesItsNoiseWhateverTheLight) {
    const Picture noise = noiseOfSeeds(100), kept = render(1);
    Picture changed = render(1);
    brighten(changed, 1.05f);
    EXPECT_GT(noiseCorrelation(noise, kept, changed).value(), 0.95);
    EXPECT_GT(noiseCorrelation(noise, kept, render(1, 0.3f, 9)).value(), kPairedCorrelation);
    for (unsigned seed = 2; seed < 52; ++seed)
        EXPECT_LT(std::abs(noiseCorrelation(noise, kept, render(seed)).value()), 0.2) << seed;
}

// What is brighter as a whole, by region, is light.
TEST(Pairs, LightIsNoNoise) {
    const Picture noise = noiseOfSeeds(100);
    Picture a = render(1), b = render(2);
    for (Picture* picture : {&a, &b})
        for (Channel& channel : picture->channels)
            for (std::size_t i = 0; i < channel.values.size(); ++i)
                if (i % 24 < 8) channel.values[i] *= 1.5f;
    EXPECT_LT(std::abs(noiseCorrelation(noise, a, b).value()), 0.2);
}

TEST(Pairs, WithoutNoiseNothingIsKnown) {
    const Picture noise = noiseOfSeeds(100);
    Picture still = render(1);
    for (Channel& channel : still.channels) channel.values.assign(channel.values.size(), 1.0f);
    Picture same = noise;
    for (std::size_t c = 0; c < 3; ++c) same.channels[c].values = still.channels[c].values;
    EXPECT_FALSE(noiseCorrelation(same, still, still).has_value());
    Picture moved = render(1);
    moved.dataWindow = {0, 0, 24, 12};
    EXPECT_FALSE(noiseCorrelation(noise, moved, render(1)).has_value());
}

// By hand: means 1, 2 and 4, of which two twins are off by .1, .2 and 0.
TEST(Pairs, VariancesAreOfTwinsAndOfAllRegions) {
    const std::vector<double> kept{1, 2, 4};
    const PairSpread spread = pairSpreadOf(kept, {{1.1, 2.2, 4}, {0.9, 1.8, 4}});
    // v / R^2: .01, .01, 0, and the median .01.
    EXPECT_NEAR(spread.variance[0], (0.01 + 0.01) / 2 + 1e-12, 1e-9);
    EXPECT_NEAR(spread.variance[1], (0.04 + 0.04) / 2 + 4e-12, 1e-9);
    EXPECT_NEAR(spread.variance[2], (0 + 0.16) / 2 + 16e-12, 1e-9);
    EXPECT_NEAR(seenByPairs(spread), kPairLimit * 0.1, 1e-6);
    const RegionFinding found = furthestOfPair({0, 0, 8, 8}, spread, {1.1, 1.4, 4});
    EXPECT_EQ(found.channel, 1);
    EXPECT_NEAR(found.z, -0.6 / 0.2, 1e-6);
    EXPECT_NEAR(found.relative, -0.3, 1e-9);
}

TEST(Pairs, BlackThatStaysBlackIsRightAndLightInItIsNot) {
    const std::vector<double> kept{0, 0, 0};
    const PairSpread spread = pairSpreadOf(kept, {kept, kept});
    EXPECT_EQ(furthestOfPair({0, 0, 8, 8}, spread, kept).z, 0);
    EXPECT_GT(furthestOfPair({0, 0, 8, 8}, spread, {0, 1e-6, 0}).z, kPairLimit);
    EXPECT_EQ(seenByPairs(spread), 0);
}

}  // namespace
}  // namespace pm::host
