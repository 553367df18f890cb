// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// What passes do: bias and variance fall as the radii's schedule says they must, and memory stays.
// With a = 2/3 the squared radius of pass i falls as i^(a-1), so that the mean of i passes has a
// squared bias that falls as i^(-2(1-a)) and a variance that falls as i^(-a) (Knaus & Zwicker
// 2011, section 4).
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numbers>
#include <vector>

#include "integrator/transport/frame_renderer.h"
#include "tests/support/replicates.h"
#include "tests/support/rooms.h"

namespace pm::test {
namespace {

constexpr double kAlpha = 2.0 / 3.0;
const std::atomic<bool> kNotCancelled{false};

// A floor at z = 0 under glass that bends no light to speak of: caustics, and so density estimates,
// of light that is known.
SceneMaker floorUnderASheet(double sheetTo) {
    SceneMaker maker;
    maker.quad({-4, -4, 0}, {8, 0, 0}, {0, 8, 0}, maker.diffuse(Rgb(0.5f)));
    const MaterialDescription clear = glass(1.00001f);
    maker.quad({-4, -4, 1}, {4 + sheetTo, 0, 0}, {0, 8, 0}, maker.material(clear));
    maker.camera({0, 0, 0.9}, {0, 0, 0}, {0, 1, 0}, 60);
    return maker;
}

// Caustics alone.
Plan causticPlan(std::uint64_t photons) {
    Plan plan;
    plan.tracePhotons = plan.causticMap = true;
    plan.causticPhotons = photons;
    return plan;
}

// estimates[render][point][i]: mean of the first i + 1 passes.
using RunningMeans = std::vector<std::vector<std::vector<double>>>;

RunningMeans estimate(const std::shared_ptr<const Scene>& scene, std::uint64_t photons,
                      std::uint32_t estimatePhotons, const std::vector<Vec3d>& points,
                      std::size_t renders, std::uint32_t passes) {
    RunningMeans means(renders);
    tbb::parallel_for(std::size_t{0}, renders, [&](std::size_t i) {
        RenderSettings settings = smallFrame(16, 16, IntegratorKind::kPhoton, passes, 3);
        settings.estimatePhotons = estimatePhotons;
        settings.seed = i + 1;
        PlannedRender render(scene, settings, causticPlan(photons));
        std::vector<double> sums(points.size());
        means[i].resize(points.size());
        NearestPhotons scratch;
        for (std::uint32_t pass = 0; pass < passes; ++pass) {
            render.begin(pass);
            for (std::size_t p = 0; p < points.size(); ++p) {
                const Vec3f at(points[p] - scene->centre());
                sums[p] += static_cast<double>(
                    render.photons().maps().caustic->irradiance(at, {0, 0, 1}, scratch).wide.r);
                means[i][p].push_back(sums[p] / (pass + 1.0));
            }
        }
    });
    return means;
}

// Over the renders.
struct BiasAndVariance {
    double bias = 0, variance = 0;
};
BiasAndVariance measure(const RunningMeans& means, std::size_t point, std::size_t pass,
                        double truth) {
    const auto n = static_cast<double>(means.size());
    double mean = 0, squares = 0;
    for (const auto& render : means) mean += render[point][pass] / n;
    for (const auto& render : means) {
        const double off = render[point][pass] - mean;
        squares += off * off;
    }
    return {mean - truth, squares / (n - 1)};
}

// Of log(y) over log(number of passes), by least squares over 4, 8, 16, ... passes.
double slope(const std::vector<double>& byPass) {
    double n = 0, x = 0, y = 0, xx = 0, xy = 0;
    for (std::size_t i = 4; i <= byPass.size(); i *= 2) {
        const double u = std::log(static_cast<double>(i)), v = std::log(byPass[i - 1]);
        n += 1, x += u, y += v, xx += u * u, xy += u * v;
    }
    return (n * xy - x * y) / (n * xx - x * x);
}

// Irradiance of a sphere lamp straight above: pi L R^2 h / (h^2 + d^2)^(3/2), which a disc around
// the foot sees less of the wider it is.
TEST(Passes, SlopesWhereLightIsSmooth) {
    SceneMaker maker = floorUnderASheet(4);
    const double height = 2, lampRadius = 0.3;
    maker.sphere({0, 0, height}, lampRadius, maker.diffuse({}, Rgb(1.0f)));
    const double truth = std::numbers::pi * lampRadius * lampRadius / (height * height);
    constexpr std::uint32_t kPasses = 32;
    // Few photons to a disc: of many, which are stratified, the count varies less than theory's.
    const RunningMeans means = estimate(maker.build(), 2000, 47, {{0, 0, 0}}, 200, kPasses);
    std::vector<double> squaredBias, variance;
    for (std::size_t i = 0; i < kPasses; ++i) {
        const BiasAndVariance m = measure(means, 0, i, truth);
        squaredBias.push_back(m.bias * m.bias);
        variance.push_back(m.variance);
        if (((i + 1) & i) == 0)
            fmt::print("    {:2} passes: bias {:+.2f} %, standard deviation {:.2f} %\n", i + 1,
                       100 * m.bias / truth, 100 * std::sqrt(m.variance) / truth);
    }
    fmt::print("    slopes: squared bias {:.3f}, variance {:.3f}\n", slope(squaredBias),
               slope(variance));
    // By 20 times as many seeds it is -.60 +- .02: the smallest passes are beside the asymptote.
    EXPECT_NEAR(slope(squaredBias), -2 * (1 - kAlpha), 0.25);
    EXPECT_NEAR(slope(variance), -kAlpha, 0.15);
    EXPECT_GT(squaredBias[0], 0.05 * 0.05 * truth * truth);
}

// The edge of the sheet's light, a step: its blur grows as narrow as the discs do.
TEST(Passes, AStepGrowsSharp) {
    SceneMaker maker = floorUnderASheet(0);
    const double height = 2;
    maker.pointLight({0, 0, height}, Rgb(1.0f));
    std::vector<Vec3d> points;
    for (int i = -15; i <= 15; i += 2) points.push_back({0.03 * i, 0.05, 0});
    constexpr std::uint32_t kPasses = 32;
    constexpr std::size_t kRenders = 40;
    const RunningMeans means = estimate(maker.build(), 8000, 100, points, kRenders, kPasses);
    std::vector<double> squaredBias(kPasses);
    const auto n = static_cast<double>(points.size());
    for (std::size_t p = 0; p < points.size(); ++p) {
        const double d2 = lengthSquared(points[p]) + height * height;
        const double truth = points[p].x < 0 ? height / (d2 * std::sqrt(d2)) : 0;
        for (std::size_t i = 0; i < kPasses; ++i) {
            const BiasAndVariance m = measure(means, p, i, truth);
            const double scale = height * height * height * height / n;
            squaredBias[i] += (m.bias * m.bias - m.variance / kRenders) * scale;
        }
    }
    for (std::size_t i = 1; i <= kPasses; i *= 4)
        fmt::print("    {:2} passes: rms bias {:.2f} %\n", i, 100 * std::sqrt(squaredBias[i - 1]));
    // A step's blur is as high at any width; what falls is how wide it is: as the radius.
    fmt::print("    slope of squared bias {:.3f}\n", slope(squaredBias));
    EXPECT_NEAR(slope(squaredBias), -(1 - kAlpha) / 2, 0.1);
}

// A point light and a camera above a slab of glass, a floor below it: no path tracer finds that
// light. T = 2n/(n^2+1) each way; the slab lifts the floor by t (1 - 1/n).
TEST(Passes, SpecularDiffuseSpecularConverges) {
    SceneMaker maker;
    maker.quad({-0.5, -0.5, 0}, {1, 0, 0}, {0, 1, 0}, maker.diffuse(Rgb(0.5f)));
    const double n = 1.5, thickness = 0.05, height = 6;
    maker.box({-2, -2, 1}, {2, 2, 1 + thickness}, maker.material(glass()), false);
    maker.pointLight({0, 0, height}, Rgb(1.0f));
    maker.camera({0, 0.3, 4}, {0, 0, 0}, {0, 1, 0}, 6);  // sees 0.4 of the floor
    const auto scene = maker.build();
    const double transmitted = 2 * n / (n * n + 1);
    const double distance = height - thickness * (1 - 1 / n);
    const double expected =
        transmitted * transmitted * 0.5 / std::numbers::pi / (distance * distance);
    const std::vector<Rect> pixels = squares(16, 16, 1);
    std::vector<double> rms;
    for (const std::uint32_t passes : {2u, 8u, 32u}) {
        const auto renders = replicate(4, [&](std::uint64_t seed) {
            RenderSettings settings = smallFrame(16, 16, IntegratorKind::kPhoton, passes, 3);
            settings.photons = 20'000;
            settings.seed = seed;
            return render(scene, settings, pixels);
        });
        double mean = 0, squares = 0;
        const auto count = static_cast<double>(pixels.size());
        for (std::size_t r = 0; r < pixels.size(); ++r) {
            EXPECT_EQ(spread(renders, r, kDirect, 0).mean, 0.0);
            mean += spread(renders, r, kCaustic, 0).mean / count;
            for (const RegionMeans& one : renders)
                squares += std::pow(one[r][kCaustic][0] / expected - 1, 2) / (4 * count);
        }
        rms.push_back(std::sqrt(squares));
        fmt::print("    {:2} passes: {:.4f} of what is expected, pixels off by {:.2f} %\n", passes,
                   mean / expected, 100 * rms.back());
        EXPECT_NEAR(mean / expected, 1, 0.01);
    }
    // Photons are stratified: the relative variance of a disc's count n goes as its rim, n^(-3/2),
    // not as 1 / n. As n falls with passes^(-1/3), 16 times the passes have 16^(-1/4) = 0.5 of the
    // error (0.516 from 16 seeds); photons chosen at glass have 16^(-1/3), of twice as much.
    EXPECT_LT(rms[2], 0.6 * rms[0]);
    EXPECT_LT(rms[0], 0.035);
}

// Resident memory, bytes; 0 where it can't be found out.
std::uint64_t residentBytes() {
    std::ifstream file("/proc/self/statm");
    std::uint64_t pages = 0, resident = 0;
    return file >> pages >> resident ? resident * 4096 : 0;
}

TEST(Passes, MemoryDoesNotGrow) {
    SceneMaker maker = openRoom();
    ceilingLamp(maker, 0.5, Rgb(8.0f));
    maker.sphere({0.3, -0.5, 0.2}, 0.4, maker.material(glass()));
    RenderSettings settings = smallFrame(48, 48, IntegratorKind::kPhoton, 32, 3);
    settings.photons = 20'000;
    FrameRenderer renderer(maker.build(), settings);
    const Rect frame{0, 0, 48, 48};
    std::vector<float> pixels(static_cast<std::size_t>(48 * 48 * renderer.layout().count));
    std::vector<float> weights(48 * 48);
    std::uint64_t mapsBefore = 0, residentBefore = 0;
    for (std::uint32_t pass = 0; pass < 32; ++pass) {
        renderer.beginPass(pass, kNotCancelled, {});
        renderer.renderRegion(frame, pixels, weights, kNotCancelled);
        if (pass != 7) continue;
        mapsBefore = renderer.counters().peakMapBytes;
        residentBefore = residentBytes();
    }
    EXPECT_GT(mapsBefore, 1'000'000u);
    // But for patches of surfaces, finer as radii shrink, at most 32 MiB of them; far less than
    // what the maps of 24 passes take.
    EXPECT_LT(renderer.counters().peakMapBytes, mapsBefore + 4'000'000);
    if (residentBefore > 0) {
        EXPECT_LT(residentBytes(), residentBefore + 8'000'000);
    }
}

// The pixels of one pass of a renderer's frame of 16 x 16.
std::vector<float> firstPass(FrameRenderer&& renderer) {
    std::vector<float> pixels(static_cast<std::size_t>(16 * 16 * renderer.layout().count));
    std::vector<float> weights(16 * 16);
    renderer.beginPass(0, kNotCancelled, {});
    renderer.renderRegion({0, 0, 16, 16}, pixels, weights, kNotCancelled);
    return pixels;
}

// Settings that the plan alone reads, so the same plan under others is the same picture.
TEST(Passes, FollowThePlanThatIsGiven) {
    SceneMaker maker = openRoom();
    ceilingLamp(maker, 0.5, Rgb(8.0f));
    const std::shared_ptr<const Scene> scene = maker.build();
    const RenderSettings settings = smallFrame(16, 16, IntegratorKind::kPhoton, 1, 3);
    RenderSettings other = settings;
    other.photons = 3000;
    other.gatherRays = 7;
    const std::vector<float> wanted = firstPass(FrameRenderer(scene, other));
    EXPECT_NE(wanted, firstPass(FrameRenderer(scene, settings)));
    EXPECT_EQ(wanted, firstPass(FrameRenderer(scene, settings, makePlan(*scene, other))));
}

}  // namespace
}  // namespace pm::test
