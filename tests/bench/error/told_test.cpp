// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// What renders say of their error, bias included, against the truth: the quickest of the twelve
// unlike scenes, few seeds. The bench pm_bench_unlike has all of them.
#include <gtest/gtest.h>

#include <span>
#include <string>
#include <vector>

#include "tests/bench/error/estimate_run.h"
#include "tests/bench/error/unlike_scenes.h"
#include "tests/bench/run/picture_error.h"

namespace pm::bench {
namespace {

constexpr std::int32_t kSize = 24;
constexpr std::uint32_t kPasses = 4;
constexpr int kSeeds = 3;

RenderSettings settingsFor(std::uint32_t passes, std::uint64_t seed) {
    RenderSettings settings;
    settings.width = settings.height = kSize;
    settings.window = {0, 0, kSize, kSize};
    settings.passes = passes;
    settings.aaLevelMost = 5;
    settings.seed = seed;
    return settings;
}

RenderSettings pathSettings() {
    RenderSettings settings = settingsFor(4, 1001);
    settings.integrator = IntegratorKind::kPath;
    settings.aaLevel = 6;
    settings.aaLevelMost = 0;
    return settings;
}

// Of many photons and few to an estimate: little bias.
RenderSettings narrowSettings() {
    RenderSettings settings = settingsFor(4, 1001);
    settings.photons = 800'000;
    settings.estimatePhotons = 12;
    return settings;
}

// Over the seeds, of the relMSE: the mean of the true one and of what is told; of the latter noise
// alone, too.
struct Means {
    double truth = 0, told = 0, noise = 0;
};

// photons: of a pass, 0: as many as the plan says.
Means meansOf(const std::string& key, std::uint64_t photons = 0) {
    for (const UnlikeScene& scene : unlikeScenes()) {
        if (scene.key != key) continue;
        const PassSource source(scene.maker.build(), "", {}, 1);
        // The noise of its halves is independent: their product has none on the average.
        const Halves r = source.halves(scene.byPaths ? pathSettings() : narrowSettings());
        Means means;
        for (int seed = 1; seed <= kSeeds; ++seed) {
            RenderSettings settings = settingsFor(kPasses, static_cast<std::uint64_t>(10 + seed));
            settings.photons = photons;
            const Judged last = source.judged(settings).back();
            std::vector<double> moved = last.rgb;
            for (std::size_t i = 0; i < moved.size(); ++i) moved[i] += r.even[i] - r.odd[i];
            means.truth += relativeError(last.rgb, moved, r.even, 0) / kSeeds;
            means.told += last.estimate.total() / kSeeds;
            means.noise += last.estimate.noise / kSeeds;
        }
        return means;
    }
    return {};
}

void expectTrue(const Means& means) {
    ASSERT_GT(means.truth, 0.0);
    EXPECT_GT(means.told, 0.5 * means.truth);
    EXPECT_LT(means.told, 2.0 * means.truth);
}

TEST(ToldError, isTrueWhereMostIsNoise) {
    expectTrue(meansOf("cupboard"));
    expectTrue(meansOf("slits"));
}

// Filaments of light under water, which so few photons blur.
TEST(ToldError, isTrueWhereMostIsBias) {
    const Means water = meansOf("water", 20'000);
    expectTrue(water);
    EXPECT_LT(water.noise, 0.5 * water.told);
}

}  // namespace
}  // namespace pm::bench
