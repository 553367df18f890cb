// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// The promise of the same bits of the whole renderer through the C interface: all that a host may
// choose without a say in the picture, every two choices together at least once, on a scene with
// every kind of transport. All combinations are pm_bench_same_bits.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <set>

#include "tests/abi/host.h"
#include "tests/determinism/same_bits_matrix.h"

namespace pm::test {

namespace {

constexpr Way plainWay() {
    return Way{.window = kSameBitsFrame};
}

const LayerPixels& layerOf(const LayeredPicture& picture, const std::string& name) {
    return *std::ranges::find(picture.layers, name, &LayerPixels::name);
}

void expectSame(SameBitsStudio& studio, const SameBitsMatrix& matrix,
                const Combinations& combinations) {
    EXPECT_EQ("", studio.differenceOf(plainWay()));
    for (const Combination& combination : combinations) {
        const Way way = matrix.wayOf(combination);
        EXPECT_EQ("", studio.differenceOf(way)) << way.text();
    }
    const auto& [withinAPass, betweenPasses, tooLate] = studio.interruptions();
    EXPECT_EQ(withinAPass + betweenPasses + tooLate,
              std::ranges::count_if(combinations, [&](const Combination& c) {
                  return matrix.wayOf(c).resumeThreads > 0;
              }));
    std::cout << combinations.size() << " combinations; resumed within a pass " << withinAPass
              << ", between passes " << betweenPasses << ", at the end " << tooLate << "\n";
}

void expectEveryTransport(const LayeredPicture& picture) {
    EXPECT_EQ(picture.layers.size(), api().layerCount());
    for (const LayerPixels& layer : picture.layers) {
        if (layer.name == "aalevel") continue;
        const auto lit = std::ranges::count_if(layer.values, [](float v) { return v > 0.0f; });
        EXPECT_GT(lit, layer.name == "emission" ? 20 : 1000) << layer.name;
    }
}

TEST(SameBitsPairs, SceneHasEveryTransport) {
    SameBitsStudio studio(pairSettings());
    const LayeredPicture picture = studio.make(plainWay());
    expectEveryTransport(picture);
    const auto [least, most] = std::ranges::minmax(layerOf(picture, "samples").values);
    EXPECT_LT(least, most) << "all pixels have as many samples";
}

// Pixels of four that stay one and such that are divided, these with unlike numbers of samples.
TEST(SameBitsPairs, FullMatrixHasEveryTransport) {
    for (const bool isOneBucket : {false, true}) {
        SameBitsStudio studio(fullMatrixSettings(isOneBucket));
        const LayeredPicture picture = studio.make(plainWay());
        expectEveryTransport(picture);
        const std::vector<float>& levels = layerOf(picture, "aalevel").values;
        const std::vector<float>& samples = layerOf(picture, "samples").values;
        const auto groups = std::ranges::count(levels, 0.0f);
        EXPECT_GT(groups, 500);
        EXPECT_LT(groups, 6400);
        std::set<float> numbers;
        for (std::size_t i = 0; i < levels.size(); ++i)
            if (levels[i] > 0.0f) numbers.insert(samples[i]);
        EXPECT_GT(numbers.size(), 1u) << "all divided pixels have as many samples";
    }
}

TEST(SameBitsPairs, EveryTwoChoicesTogether) {
    const SameBitsMatrix matrix;
    SameBitsStudio studio(pairSettings());
    expectSame(studio, matrix, coveringSet(matrix.possible()));
    // Resuming is tested where something was left to do, and most of all within a pass. Where a
    // cancel falls is a matter of time: asked of many resumed renders only.
    const auto& [withinAPass, betweenPasses, tooLate] = studio.interruptions();
    EXPECT_GT(withinAPass, 0);
    EXPECT_GT(withinAPass + betweenPasses, tooLate);
}

// Where pixels of four begin as one, samples lie outside of theirs, and gather rays go by pilot and
// guide.
TEST(SameBitsPairs, LevelZeroAndAWideFilter) {
    Settings settings = {
        {"aaLevel", "0"}, {"filter", "gaussian"}, {"gatherRays", "0"}, {"plan", "everything"}};
    settings.merge(pairSettings());
    const SameBitsMatrix matrix;
    SameBitsStudio studio(settings);
    const LayeredPicture picture = studio.make(plainWay());
    const auto groups = std::ranges::count(layerOf(picture, "aalevel").values, 0.0f);
    EXPECT_GT(groups, 500);
    EXPECT_LT(groups, 6400);
    Combinations some;
    const Combinations all = coveringSet(matrix.possible());
    for (std::size_t i = 0; i < all.size(); i += 5) some.push_back(all[i]);
    expectSame(studio, matrix, some);
}

TEST(SameBitsPairs, SharesAreTheWhole) {
    std::vector<std::size_t> found;
    for (std::size_t share = 1; share <= 7; ++share)
        for (const std::size_t i : indicesOfShare(100, share, 7)) found.push_back(i);
    std::ranges::sort(found);
    ASSERT_EQ(found.size(), 100u);
    for (std::size_t i = 0; i < found.size(); ++i) EXPECT_EQ(found[i], i);
}

// What the comparison is for, seen and named: one bit of one pixel, another seed.
TEST(SameBitsPairs, DifferencesAreNamed) {
    SameBitsStudio studio(fullMatrixSettings(false));
    const LayeredPicture expected = studio.make(plainWay());
    LayeredPicture broken = expected;
    float& value = broken.layers[2].values[(5 * 96 + 7) * 3 + 1];
    value = std::nextafter(value, 1e9f);
    const std::string text = difference(broken, expected);
    EXPECT_NE(std::string::npos, text.find("pixel 7,5, layer indirect, channel indirect.G"))
        << text;
    EXPECT_NE(std::string::npos, text.find("1 of 6912 pixels differ")) << text;
    Settings other = {{"seed", "2"}};
    other.merge(fullMatrixSettings(false));
    EXPECT_NE("", difference(SameBitsStudio(other).make(plainWay()), expected));
}

}  // namespace

}  // namespace pm::test
