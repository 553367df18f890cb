// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/transport/frame/pixel_sums.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <optional>
#include <utility>
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

std::optional<FaultySample> faultOf(const Rgb& value, PathClass part) {
    SampleRadiance sample = hit({});
    sample.of(part) = value;
    return PixelSums::faultOf(sample);
}

TEST(SampleFaults, AreNamedByTheirKindAndPart) {
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    for (const PathClass part :
         {PathClass::kEmission, PathClass::kDirect, PathClass::kCaustic, PathClass::kIndirect}) {
        EXPECT_EQ(faultOf(Rgb(0, 1, 1e30f), part), std::nullopt);
        EXPECT_EQ(faultOf(Rgb(0, std::nanf(""), kInfinity), part),
                  (FaultySample{SampleFault::kNan, part}));
        EXPECT_EQ(faultOf(Rgb(0, 0, kInfinity), part),
                  (FaultySample{SampleFault::kInfinite, part}));
        EXPECT_EQ(faultOf(Rgb(0, -kInfinity, 0), part),
                  (FaultySample{SampleFault::kInfinite, part}));
        EXPECT_EQ(faultOf(Rgb(0.1f, -0.2f, 0), part), (FaultySample{SampleFault::kNegative, part}));
    }
}

// Colours outside of the gamut have channels below 0 and are light all the same.
TEST(SampleFaults, WideColoursAreNone) {
    EXPECT_EQ(faultOf(Rgb(-0.1f, 0.6f, 0.04f), PathClass::kDirect), std::nullopt);
}

TEST(SampleFaults, PartsThatOverflowTogetherAreOne) {
    SampleRadiance sample = hit({});
    sample.emission = sample.direct = Rgb(3e38f);
    EXPECT_EQ(PixelSums::faultOf(sample),
              (FaultySample{SampleFault::kInfinite, PathClass::kEmission}));
    sample = hit({});
    sample.biasProbe = Rgb(-1.0f);  // a difference
    EXPECT_EQ(PixelSums::faultOf(sample), std::nullopt);
}

TEST(SampleFaults, AreCountedAndTheFirstIsKept) {
    const FaultySample nan{SampleFault::kNan, PathClass::kDirect};
    const FaultySample negative{SampleFault::kNegative, PathClass::kCaustic};
    BadSamples a, b;
    a.add({1, 5, 3, 0, nan});
    a.add({0, 9, 3, 2, negative});
    b.add({0, 9, 2, 7, nan});
    for (auto [one, other] : {std::pair{a, b}, std::pair{b, a}}) {
        one.add(other);
        EXPECT_EQ(one.total(), 3u);
        EXPECT_EQ(one.counts[0], 2u);
        EXPECT_EQ(one.counts[2], 1u);
        EXPECT_EQ(*one.first, (BadSamples::Place{0, 9, 2, 7, nan}));
    }
}

}  // namespace
}  // namespace pm::test
