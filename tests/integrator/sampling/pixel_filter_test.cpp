// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Filters: where samples are placed, and what pictures that makes.
#include "integrator/sampling/pixel_filter.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numbers>
#include <vector>

#include "integrator/sampling/sampler.h"
#include "tests/support/scene_maker.h"
#include "tests/support/statistics.h"

namespace pm::test {
namespace {

// 1 % for the whole file, shared among at most 10 tests.
constexpr double kSignificance = 0.01 / 10;

double normalBelow(double z) {
    return 0.5 * std::erfc(-z / std::numbers::sqrt2);
}

// Share of a filter that lies below a place, pixels from its left edge. sigma: in pixels, 0 = box.
double filterBelow(double place, double sigma) {
    if (sigma == 0) return std::clamp(place, 0.0, 1.0);
    const double cut = normalBelow(-1.5 / sigma);
    const double z = std::clamp(place - 0.5, -1.5, 1.5) / sigma;
    return (normalBelow(z) - cut) / (1 - 2 * cut);
}

double sigmaOf(PixelFilter filter) {
    return filter == PixelFilter::kBox ? 0.0 : 0.5;
}

TEST(PixelFilter, QuantileIsTheNormalDistributions) {
    for (int i = 1; i < 4999; ++i) {
        const double q = i / 1e4;
        const double z = standardNormalQuantile(q);
        EXPECT_EQ(standardNormalQuantile(-q), -z);
        // A relative error e of z is one of z e density(z) of the probability.
        const double density = std::exp(-0.5 * z * z) / std::sqrt(2 * std::numbers::pi);
        ASSERT_NEAR(normalBelow(z) - 0.5, q, 1e-6 * z * density) << q;
    }
    EXPECT_EQ(standardNormalQuantile(0.0), 0.0);
}

// All that the 24 bits of a random number can ask for, in steps.
TEST(PixelFilter, PlacesRiseAndStayWithinTheFilter) {
    double before = -1.5;
    for (std::uint32_t i = 0; i < 1u << 24; i += 7) {
        const double place = placeInPixel(PixelFilter::kGaussian, static_cast<float>(i) * 0x1p-24f);
        ASSERT_GT(place, before) << i;
        before = place;
    }
    EXPECT_NEAR(placeInPixel(PixelFilter::kGaussian, 0.0f), -1.0, 1e-6);
    EXPECT_NEAR(before, 2.0, 1e-4);
    EXPECT_LT(before, 2.0);
    EXPECT_EQ(placeInPixel(PixelFilter::kBox, 0.25f), 0.25);
}

TEST(PixelFilter, PlacesFollowTheDensity) {
    Random random(1);
    for (const PixelFilter filter : {PixelFilter::kBox, PixelFilter::kGaussian}) {
        // The square [-1.5, 2.5)^2 around a pixel as the unit square: filters end where bins do.
        const auto sample = [&]() -> std::optional<Vec2f> {
            const Vec2f u = random.next2D();
            return Vec2f{static_cast<float>((placeInPixel(filter, u.x) + 1.5) / 4),
                         static_cast<float>((placeInPixel(filter, u.y) + 1.5) / 4)};
        };
        const auto density = [](double sigma) {
            const auto along = [sigma](double t) {
                const double off = 4 * t - 2;
                if (sigma == 0) return std::abs(off) < 0.5 ? 4.0 : 0.0;
                const double z = off / sigma;
                const double peak = 4 / sigma / std::sqrt(2 * std::numbers::pi);
                return std::abs(off) < 1.5
                           ? peak * std::exp(-0.5 * z * z) / (1 - 2 * normalBelow(-1.5 / sigma))
                           : 0.0;
            };
            return [along](double x, double y) { return along(x) * along(y); };
        };
        EXPECT_GT(squarePValue(400'000, sample, density(sigmaOf(filter))), kSignificance);
        // Twins: a wider normal, or the other filter.
        EXPECT_LT(squarePValue(400'000, sample, density(0.51)), kSignificance);
        EXPECT_LT(squarePValue(400'000, sample, density(sigmaOf(filter) == 0 ? 0.5 : 0)),
                  kSignificance);
    }
}

TEST(PixelFilter, Moments) {
    Random random(2);
    constexpr int kCount = 1'000'000;
    double sum = 0, squares = 0, fourths = 0;
    for (int i = 0; i < kCount; ++i) {
        const double off = placeInPixel(PixelFilter::kGaussian, random.next()) - 0.5;
        sum += off;
        squares += off * off;
        fourths += off * off * off * off;
    }
    // Of a normal variable cut off at c standard deviations.
    const double c = 3, atCut = std::exp(-0.5 * c * c) / std::sqrt(2 * std::numbers::pi);
    const double variance = 0.25 * (1 - 2 * c * atCut / (normalBelow(c) - normalBelow(-c)));
    const double measured = squares / kCount;
    EXPECT_NEAR(sum / kCount, 0, 4 * std::sqrt(variance / kCount));
    EXPECT_NEAR(measured, variance,
                4 * std::sqrt((fourths / kCount - measured * measured) / kCount));
}

// The sampler's points stay one to each of as many equal parts of the filter.
TEST(PixelFilter, KeepsStrata) {
    for (const std::uint32_t count : {16u, 256u})
        for (std::uint64_t sequence = 0; sequence < 20; ++sequence) {
            std::vector<int> alongX(count), alongY(count);
            for (std::uint32_t i = 0; i < count; ++i) {
                const Sampler sampler(3, 0, sequence, i);
                const Vec2f u = sampler.get2D(Purpose::kPlace);
                const auto part = [&](float v) {
                    const double place = placeInPixel(PixelFilter::kGaussian, v);
                    return static_cast<std::size_t>(filterBelow(place, 0.5) * count);
                };
                ++alongX[part(u.x)];
                ++alongY[part(u.y)];
            }
            EXPECT_EQ(std::ranges::count(alongX, 1), count);
            EXPECT_EQ(std::ranges::count(alongY, 1), count);
        }
}

// A picture of a bright quadrant whose corner is at kCorner, from straight above.
constexpr std::int32_t kSize = 12;
constexpr double kCornerX = 5.3, kCornerY = 0.4;  // pixels; the upper edge also at the frame's

std::shared_ptr<const Scene> quadrant() {
    SceneMaker maker;
    const double pixel = 2.0 / kSize;  // of the plane z = 0, at a field of view of 90 degrees
    const double x = (kCornerX - 0.5 * kSize) * pixel, y = (0.5 * kSize - kCornerY) * pixel;
    maker.quad({x, y - 9, 0}, {9, 0, 0}, {0, 9, 0}, maker.diffuse({}, Rgb(1.0f)));
    maker.camera({0, 0, 1}, {0, 0, 0}, {0, 1, 0}, 90);
    return maker.build();
}

// Emission of the pixels of `region`, row by row, over all passes.
std::vector<double> emissionOf(const std::shared_ptr<const Scene>& scene,
                               const RenderSettings& settings, const Rect& region) {
    FrameRenderer renderer(scene, settings);
    const auto channels = static_cast<std::size_t>(renderer.layout().count);
    const auto area = static_cast<std::size_t>(region.area());
    std::vector<float> pixels(area * channels), weights(area);
    std::vector<double> sums(area), counts(area);
    const std::atomic<bool> cancelled{false};
    for (std::uint32_t pass = 0; pass < settings.passes; ++pass) {
        renderer.beginPass(pass, cancelled, {});
        renderer.renderRegion(region, pixels, weights, cancelled);
        for (std::size_t i = 0; i < area; ++i) {
            const auto weight = static_cast<double>(weights[i]);
            counts[i] += weight;
            sums[i] +=
                weight *
                static_cast<double>(
                    pixels[i * channels + static_cast<std::size_t>(renderer.layout().emission)]);
        }
    }
    for (std::size_t i = 0; i < area; ++i) sums[i] /= counts[i];
    return sums;
}

// Largest distance of a picture of the quadrant from a filter's integral over it, in standard
// errors of as many independent samples: those of the sampler are spread better.
double largestScore(PixelFilter filter, std::uint32_t level, double sigma) {
    RenderSettings settings = smallFrame(kSize, kSize, IntegratorKind::kPath, 64, level);
    settings.filter = filter;
    const auto picture = emissionOf(quadrant(), settings, settings.window);
    // A level-0 group is a pixel of twice the side.
    const int side = level == 0 ? 2 : 1;
    const double samples = 16 * std::pow(4.0, level == 0 ? 0 : level - 1);
    double largest = 0;
    for (std::int32_t y = 0; y < kSize; ++y)
        for (std::int32_t x = 0; x < kSize; ++x) {
            const auto share = [&](double corner, std::int32_t at) {
                return 1 - filterBelow((corner - at / side * side) / side, sigma);
            };
            const double expected = share(kCornerX, x) * share(kCornerY, y);
            const double variance = std::max(expected * (1 - expected), 1e-12);
            const double off = picture[static_cast<std::size_t>(y * kSize + x)] - expected;
            // Half a sample: the mean is a whole number of them.
            const double error = std::sqrt(variance / samples) + 0.5 / samples;
            largest = std::max(largest, std::abs(off) / error);
        }
    return largest;
}

TEST(PixelFilter, AStepIsTheFiltersIntegral) {
    for (const PixelFilter filter : {PixelFilter::kBox, PixelFilter::kGaussian})
        for (const std::uint32_t level : {0u, 3u})
            EXPECT_LT(largestScore(filter, level, sigmaOf(filter)), 4) << level;
    // Twins: the other filter's integral.
    EXPECT_GT(largestScore(PixelFilter::kBox, 4, 0.5), 4);
    EXPECT_GT(largestScore(PixelFilter::kGaussian, 4, 0), 4);
}

// What is even stays so, up to and beyond the frame's edges: samples that lie outside of the frame
// find what they need.
TEST(PixelFilter, EvenLightStaysEven) {
    SceneMaker maker;
    maker.box({-1, -1, -1}, {1, 1, 1}, maker.diffuse(Rgb(0.5f), Rgb(0.5f)), true);
    maker.camera({0.1, 0.2, 0.3}, {1, 0.4, -0.2}, {0, 1, 0}, 60);
    const auto scene = maker.build();
    for (const IntegratorKind integrator : {IntegratorKind::kPhoton, IntegratorKind::kPath})
        for (const std::uint32_t level : {0u, 3u}) {
            RenderSettings settings = smallFrame(15, 15, integrator, 8, level);
            settings.photons = 20'000;
            settings.filter = PixelFilter::kGaussian;
            // In a narrow region a pass of level 0 may have no sample.
            std::vector<Rect> regions = {{-2, -2, 17, 17}};
            if (level > 0) regions.insert(regions.end(), {{-2, -2, 17, 0}, {0, 14, 15, 16}});
            for (const MeasuredLayers& m :
                 measureRegions(scene, settings, {-2, -2, 17, 17}, regions)) {
                EXPECT_TRUE(agrees(m.emission, Rgb(0.5f), 0));
                EXPECT_TRUE(
                    agrees(m.beauty, Rgb(1.0f), integrator == IntegratorKind::kPhoton ? 0.002 : 0));
            }
        }
}

// Pixels of a group show one value, which is that of the group whatever part of it is asked for.
TEST(PixelGroups, ShareTheirSamples) {
    const auto scene = quadrant();
    RenderSettings settings = smallFrame(kSize, kSize, IntegratorKind::kPath, 4, 0);
    const auto whole = emissionOf(scene, settings, {-4, -4, kSize, kSize});
    const auto at = [&](std::int32_t x, std::int32_t y) {
        return whole[static_cast<std::size_t>((y + 4) * (kSize + 4) + x + 4)];
    };
    for (std::int32_t y = -4; y < kSize; ++y)
        for (std::int32_t x = -4; x < kSize; ++x) EXPECT_EQ(at(x, y), at(x & ~1, y & ~1));
    const Rect odd{-1, 3, 8, 6};
    const auto part = emissionOf(scene, settings, odd);
    for (std::int32_t y = odd.y0; y < odd.y1; ++y)
        for (std::int32_t x = odd.x0; x < odd.x1; ++x)
            EXPECT_EQ(part[static_cast<std::size_t>((y - odd.y0) * odd.width() + x - odd.x0)],
                      at(x, y));
}

// One sample a group in four passes, in turns of either half; fewer passes leave no hole.
TEST(PixelGroups, FixedLevelTakesASampleInFourPasses) {
    for (const std::uint32_t passes : {1u, 3u, 4u, 16u}) {
        const RenderSettings settings = smallFrame(8, 8, IntegratorKind::kPath, passes, 0);
        for (std::int32_t y = -2; y < 8; ++y)
            for (std::int32_t x = -2; x < 8; ++x) {
                std::uint32_t halves[2] = {0, 0};
                float weight = 0;
                for (std::uint32_t pass = 0; pass < passes; ++pass) {
                    const SampleRun run = fixedSamples(settings, x, y, pass);
                    EXPECT_TRUE(run.isOfGroup);
                    EXPECT_EQ(run.first, run.count == 0 ? run.first : halves[pass % 2]);
                    halves[pass % 2] += run.count;
                    weight += run.weight();
                }
                EXPECT_EQ(weight, passes < 4 ? 0.25f : static_cast<float>(passes) / 16);
                if (passes == 16) {
                    EXPECT_EQ(halves[0], halves[1]);
                }
            }
    }
}

}  // namespace
}  // namespace pm::test
