// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/transport/pixel_sums.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace pm::test {
namespace {

SampleRadiance hit(const Vec3f& position, const Vec3f& normal = {0, 0, 1}) {
    SampleRadiance sample;
    sample.coverage = 1.0f;
    sample.firstShape = 3;
    sample.firstMaterial = 7;
    sample.firstPosition = position;
    sample.normal = normal;
    return sample;
}

Vec3f leaning(float degrees) {
    const float angle = degrees * kPi / 180;
    return {std::sin(angle), 0, std::cos(angle)};
}

// Whether samples of adaptive renders are told to lie at an edge; the last one counts or not.
bool showsEdge(const std::vector<SampleRadiance>& samples, bool isLastSeen = true) {
    RenderSettings settings;
    settings.aaLevel = 3;
    settings.aaLevelMost = 5;
    const ChannelLayout layout = channelLayout(settings);
    PixelSums sums;
    for (std::size_t i = 0; i < samples.size(); ++i)
        sums.add(samples[i], 1.0, i + 1 < samples.size() || isLastSeen);
    std::vector<float> pixel(static_cast<std::size_t>(layout.count));
    sums.write(layout, static_cast<std::uint32_t>(samples.size()), pixel.data());
    return pixel[static_cast<std::size_t>(layout.seen) + 5] == 1.0f;
}

TEST(PixelSums, seeNoEdgeOnOneSurface) {
    EXPECT_FALSE(showsEdge({hit({0, 0, 0})}));
    EXPECT_FALSE(showsEdge({hit({0, 0, 0}), hit({0, 0, 0}), hit({0.1f, 0.3f, 0})}));
    EXPECT_FALSE(showsEdge({hit({0, 0, 0}), hit({0.1f, 0, 0.03f}, leaning(20))}));
    EXPECT_FALSE(showsEdge({SampleRadiance{}, SampleRadiance{}}));  // sky alone
}

TEST(PixelSums, seeEdgesBetweenUnlikeSurfaces) {
    SampleRadiance otherShape = hit({0.1f, 0, 0}), otherMaterial = otherShape;
    otherShape.firstShape = 4;
    otherMaterial.firstMaterial = 8;
    EXPECT_TRUE(showsEdge({hit({0, 0, 0}), otherShape}));
    EXPECT_TRUE(showsEdge({hit({0, 0, 0}), otherMaterial}));
    EXPECT_TRUE(showsEdge({hit({0, 0, 0}), SampleRadiance{}}));
    EXPECT_TRUE(showsEdge({SampleRadiance{}, SampleRadiance{}, hit({0, 0, 0})}));
    EXPECT_TRUE(showsEdge({hit({0, 0, 0}), hit({0.1f, 0, 0}, leaning(40))}));
    // One plate behind the other.
    EXPECT_TRUE(showsEdge({hit({0, 0, 0}), hit({0.1f, 0, -1})}));
    // Also where a later one is as the first again.
    EXPECT_TRUE(showsEdge({hit({0, 0, 0}), otherShape, hit({0, 0.1f, 0})}));
}

TEST(PixelSums, seeEdgesBySamplesThatDecideAlone) {
    SampleRadiance other = hit({0.1f, 0, 0});
    other.firstShape = 4;
    EXPECT_FALSE(showsEdge({hit({0, 0, 0}), other}, false));
}

}  // namespace
}  // namespace pm::test
