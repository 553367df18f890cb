// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Choices that no other file holds against their probabilities: lobes, lamps, Russian roulette.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <vector>

#include "integrator/light_sampling/light_choice.h"
#include "integrator/transport/path/camera_step.h"
#include "tests/support/rooms.h"
#include "tests/support/scene_maker.h"
#include "tests/support/statistics.h"

namespace pm::test {
namespace {

// 1 % for the whole file, shared among at most 10 tests.
constexpr double kSignificance = 0.01 / 10;

// A surface in the plane z = 0.
struct Bench {
    std::shared_ptr<const Scene> scene;
    Surface surface;

    explicit Bench(const MaterialDescription& material) {
        SceneMaker maker;
        maker.quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, maker.material(material));
        scene = maker.build();
        surface.geometricNormal = surface.shadingNormal = {0, 0, 1};
    }
};

double meanOf(const Rgb& c) {
    return (static_cast<double>(c.r) + static_cast<double>(c.g) + static_cast<double>(c.b)) / 3;
}

// What each lobe of a material reflects or transmits, found without the Bsdf.
struct LobeCase {
    const char* name;
    MaterialDescription material;
    std::array<Rgb, kLobeCount> reflectance;
};

std::vector<LobeCase> lobeCases(double cosine) {
    MaterialDescription sheet;
    sheet.diffuse = {0.4f, 0.5f, 0.1f};
    sheet.glossy = {0.2f, 0.1f, 0.3f};
    sheet.glossyExponent = 10;
    sheet.transparency = 0.25f;
    MaterialDescription half = mirror(0.8f);
    half.glossy = {0.8f, 0.4f, 0.2f};
    half.transparency = 0.5f;
    MaterialDescription tinted = glass();
    tinted.transmission = {0.9f, 0.7f, 0.5f};
    const double inside = std::sqrt(1 - (1 - cosine * cosine) / 2.25);
    const double p = (1.5 * cosine - inside) / (1.5 * cosine + inside);
    const double s = (cosine - 1.5 * inside) / (cosine + 1.5 * inside);
    const auto r = static_cast<float>(0.5 * (p * p + s * s));
    const Rgb none;
    return {
        {"sheet",
         sheet,
         {sheet.diffuse * 0.75f, none, none, sheet.glossy * 0.75f, none, none, Rgb(0.25f)}},
        {"half a mirror", half, {none, none, none, none, half.glossy * 0.5f, none, Rgb(0.5f)}},
        {"glass", tinted, {none, none, none, none, Rgb(r), tinted.transmission * (1 - r), none}}};
}

// Lobes are chosen by what they would carry on; photons end with the rest.
TEST(SamplingRoutines, LobesAreChosenByWhatTheyCarry) {
    const Rgb carried{0.7f, 1.0f, 0.4f};
    const double cosine = 0.2;
    const Vec3f out(Vec3d{std::sqrt(1 - cosine * cosine), 0, cosine});
    Random random(1);
    for (const LobeCase& c : lobeCases(cosine))
        for (const Transport transport : {Transport::kRadiance, Transport::kPhotons}) {
            const Bench bench(c.material);
            const Bsdf bsdf(bench.scene->materials(), bench.surface, out, transport, carried);
            std::array<double, kLobeCount> probability;
            double sum = 0;
            for (std::size_t i = 0; i < kLobeCount; ++i)
                sum += probability[i] = meanOf(carried * c.reflectance[i]);
            const double total = transport == Transport::kPhotons ? meanOf(carried) : sum;
            Histogram right(kLobeCount + 1), wrong(kLobeCount + 1);
            double ended = 0;
            for (std::size_t i = 0; i < kLobeCount; ++i) {
                right.expect(i, probability[i] / total);
                // Twin: as if it carried the same in all channels.
                wrong.expect(i, meanOf(c.reflectance[i]) * (sum / total) /
                                    meanOf(std::accumulate(c.reflectance.begin(),
                                                           c.reflectance.end(), Rgb())));
            }
            for (int n = 0; n < 400'000; ++n) {
                // The square's centre: directions of no value are not what is tested here.
                BsdfSample sample;
                const float u = random.next();
                const bool valid = bsdf.sample(u, {0.01f, 0.25f}, sample);
                // What is left over is absorbed; glossy directions may lie below the surface.
                if (!valid && static_cast<double>(u) > sum / total) {
                    ++ended;
                    continue;
                }
                const auto i = static_cast<std::size_t>(sample.lobe);
                right.count(i);
                wrong.count(i);
                if (isDelta(sample.lobe)) {
                    ASSERT_NEAR(sample.pdfSolidAngle, probability[i] / total, 1e-5) << c.name;
                }
            }
            EXPECT_GT(right.pValue(ended), kSignificance) << c.name;
            EXPECT_LT(wrong.pValue(ended), kSignificance) << c.name;
        }
}

// The light in whose share the number lies, whatever cell of the table the search begins with: also
// at the shares' very borders, and where many lights share a cell.
TEST(SamplingRoutines, LightsAreFoundWhereTheirSharesLie) {
    Random random(5);
    for (const std::size_t count :
         {std::size_t{1}, std::size_t{2}, std::size_t{37}, std::size_t{5000}}) {
        std::vector<double> weights(count);
        for (double& weight : weights) {
            const auto u = static_cast<double>(random.next());
            weight = u * u * u * u;
        }
        weights[count / 2] += 1000;
        const LightChoice choice(weights);
        std::vector<float> ends;
        double sum = 0;
        for (std::size_t i = 0; i < count; ++i) {
            sum += static_cast<double>(choice.probability(i));
            ends.push_back(static_cast<float>(sum));
        }
        ASSERT_EQ(ends.back(), 1.0f);
        const auto check = [&](float u) {
            float stated;
            const std::uint32_t light = choice.choose(u, stated);
            ASSERT_GE(u, light > 0 ? ends[light - 1] : 0.0f) << count << " " << u;
            ASSERT_LT(u, ends[light]) << count << " " << u;
        };
        for (const float end : ends) {
            if (end < 1.0f) check(end);
            check(std::nextafter(end, 0.0f));
        }
        for (int n = 0; n < 20'000; ++n) check(random.next());
    }
}

// The choice among lights and what is left of the random number: together uniform over their
// shares.
TEST(SamplingRoutines, LightsAndWhatIsLeftOfTheNumber) {
    const std::vector<double> weights = {1, 0, 3, 100, 0.1, 20};
    const LightChoice choice(weights);
    constexpr std::size_t kParts = 8;
    const std::size_t bins = weights.size() * kParts;
    Histogram right(bins), wrong(bins), plain(weights.size());
    for (std::size_t i = 0; i < weights.size(); ++i) {
        const auto p = static_cast<double>(choice.probability(i));
        EXPECT_NEAR(p, 0.1 / 6 + 0.9 * weights[i] / 124.1, 1e-6);
        plain.expect(i, p);
        for (std::size_t part = 0; part < kParts; ++part) {
            right.expect(i * kParts + part, p / kParts);
            wrong.expect(i * kParts + part, p / kParts * (part < kParts / 2 ? 1.05 : 0.95));
        }
    }
    Random random(2);
    for (int n = 0; n < 400'000; ++n) {
        float u = random.next(), stated;
        const float before = u;
        const std::uint32_t light = choice.chooseAndStretch(u, stated);
        ASSERT_EQ(stated, choice.probability(light));
        ASSERT_TRUE(u >= 0.0f && u < 1.0f);
        const std::size_t bin = light * kParts + static_cast<std::size_t>(u * kParts);
        right.count(bin);
        wrong.count(bin);
        plain.count(choice.choose(before, stated));
    }
    EXPECT_GT(right.pValue(0), kSignificance);
    EXPECT_GT(plain.pValue(0), kSignificance);
    EXPECT_LT(wrong.pValue(0), kSignificance);
}

// Russian roulette ends paths as often as it says and keeps the mean of what goes on.
TEST(SamplingRoutines, RouletteKeepsTheMean) {
    MaterialDescription grey;
    grey.diffuse = Rgb(0.6f, 0.3f, 0.45f);
    const Bench bench(grey);
    constexpr int kEvents = 9, kPaths = 200'000;
    std::array<double, kEvents> mean{}, square{}, alive{};
    for (std::uint32_t n = 0; n < kPaths; ++n) {
        CameraStep path(Ray{{}, {0, 0, -1}}, {}, Sampler(1, 0, n, 0));
        for (std::size_t event = 0; event < kEvents; ++event) {
            const Bsdf bsdf(bench.scene->materials(), bench.surface, {0, 0, 1},
                            Transport::kRadiance, path.carried);
            BsdfSample sample;
            ASSERT_TRUE(sampleLobe(bsdf, path.random, sample));
            if (!path.scatter(bench.surface, bsdf, sample)) break;
            alive[event] += 1;
            const auto red = static_cast<double>(path.carried.r);
            mean[event] += red / kPaths;
            square[event] += red * red / kPaths;
        }
    }
    for (std::size_t event = 0; event < kEvents; ++event) {
        const double expected = std::pow(0.6, static_cast<double>(event + 1));
        const double variance = std::max(0.0, square[event] - mean[event] * mean[event]);
        EXPECT_NEAR(mean[event], expected, 4 * std::sqrt(variance / kPaths) + 1e-6) << event;
        // Until the fifth event all go on; from there on the brightest channel is what survives.
        EXPECT_EQ(alive[event] == kPaths, event < 4);
    }
    const double survivors = std::pow(0.6, 5);
    EXPECT_NEAR(alive[4] / kPaths, survivors, 4 * std::sqrt(survivors * (1 - survivors) / kPaths));
}

}  // namespace
}  // namespace pm::test
