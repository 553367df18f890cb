// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "tests/bench/adaptive/adaptive_run.h"

#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <numeric>
#include <utility>

#include "integrator/values/error_scale.h"
#include "scheduler/buckets/bucket_grid.h"
#include "scheduler/film/frame_error.h"
#include "tests/bench/run/picture_error.h"
#include "tests/bench/run/timing.h"

namespace pm::bench {

namespace {

constexpr std::uint64_t kTruthSeed = 7001, kKnownSeed = 8001;
constexpr std::uint32_t kPathLevel = 6, kPhotonLevel = 4;
constexpr std::uint32_t kNarrow = 12;     // photons to an estimate
constexpr std::uint32_t kKnownLevel = 4;  // 16 samples a pass
constexpr std::uint32_t kKnownSamples = 16, kKnownSamplesAlone = 4;
const std::atomic<bool> kNotCancelled{false};

std::vector<double> meanOf(std::span<const double> a, std::span<const double> b) {
    std::vector<double> mean(a.begin(), a.end());
    for (std::size_t i = 0; i < mean.size(); ++i) mean[i] = (mean[i] + b[i]) / 2;
    return mean;
}

// Sums over passes of what a pixel had in them.
struct PixelSums {
    std::array<double, 3> means{}, squares{};
    double within = 0;  // variance of a sample within a pass, all channels
};

void addPass(const float* pixel, const ChannelLayout& layout, double samples, PixelSums& sums) {
    const float* const seen = pixel + layout.seen;
    double square = static_cast<double>(seen[4]);
    for (std::size_t c = 0; c < 3; ++c) {
        const auto mean = static_cast<double>(pixel[layout.beauty + static_cast<std::int32_t>(c)]);
        sums.means[c] += mean;
        sums.squares[c] += mean * mean;
        square -= mean * mean * samples;
    }
    sums.within += std::max(0.0, square) / (samples - 1);
}

// Relative variances: of a sample within a pass, and of a pass's mean.
struct Variances {
    double within = 0, ofPass = 0;
};

Variances variancesOf(const PixelSums& sums, double passes) {
    double absolute = 0, relative = 0;
    for (std::size_t c = 0; c < 3; ++c) {
        const double mean = sums.means[c] / passes;
        const double variance =
            std::max(0.0, sums.squares[c] / passes - mean * mean) * passes / (passes - 1);
        absolute += variance;
        relative += variance / (mean * mean + ErrorScale().offset()) / 3;
    }
    if (!(absolute > 0)) return {};
    // As relMSE weighs the channels.
    return {sums.within / passes * relative / absolute, relative};
}

}  // namespace

double Truth::relMse(std::span<const double> picture) const {
    const std::vector<double> r = meanOf(first, second);
    double sum = 0;
    for (std::size_t i = 0; i < r.size(); ++i)
        sum += (picture[i] - first[i]) * (picture[i] - second[i]) /
               (r[i] * r[i] + ErrorScale().offset());
    return sum / static_cast<double>(r.size());
}

double Truth::ownNoise() const {
    const std::vector<double> r = meanOf(first, second);
    return relativeError(first, first, r, 0);
}

Truth makeTruth(const std::shared_ptr<const Scene>& scene, std::int32_t size, bool byPaths,
                std::uint32_t passes, int threads) {
    RenderSettings settings;
    settings.width = settings.height = size;
    settings.window = {0, 0, size, size};
    settings.passes = passes;
    settings.integrator = byPaths ? IntegratorKind::kPath : IntegratorKind::kPhoton;
    settings.aaLevel = byPaths ? kPathLevel : kPhotonLevel;
    settings.estimatePhotons = kNarrow;
    Truth truth;
    for (std::vector<double>* const half : {&truth.first, &truth.second}) {
        settings.seed = kTruthSeed + (half == &truth.first ? 0 : 1);
        PassRenderer renderer(scene, settings, makePlan(*scene, settings), threads);
        for (std::uint32_t pass = 0; pass < passes; ++pass) renderer.next();
        *half = renderer.beauty();
    }
    return truth;
}

Known measureKnown(const std::shared_ptr<const Scene>& scene, const RenderSettings& asked,
                   std::uint32_t passes, int threads) {
    RenderSettings settings = asked;
    settings.aaLevel = kKnownLevel;
    settings.aaLevelMost = kKnownLevel + 1;  // tells of its samples
    settings.seed = kKnownSeed;
    const bool isAlone = !makePlan(*scene, settings).tracePhotons;
    const std::uint32_t samples = isAlone ? kKnownSamplesAlone : kKnownSamples;
    passes *= kKnownSamples / samples;
    const Rect& frame = settings.window;
    const auto pixels = static_cast<std::size_t>(frame.area());
    std::vector<PixelSums> sums(pixels);
    Known known{std::vector<double>(pixels), std::vector<double>(pixels)};
    tbb::task_arena arena(threads);
    arena.execute([&] {
        FrameRenderer renderer(scene, settings);
        const ChannelLayout layout = renderer.layout();
        const auto channels = static_cast<std::size_t>(layout.count);
        std::vector<float> atom(kAtomPixels * channels);
        for (std::uint32_t pass = 0; pass < passes; ++pass) {
            const double start = processorSeconds();
            renderer.beginPass(pass, kNotCancelled, {});
            known.passSeconds += (processorSeconds() - start) / passes;
            const std::vector<SampleRun> runs(kAtomPixels, {pass / 2 * samples, samples, samples});
            for (std::int32_t y = 0; y < frame.y1; y += kAtomSizePixels)
                for (std::int32_t x = 0; x < frame.x1; x += kAtomSizePixels) {
                    const Rect rect{x, y, x + kAtomSizePixels, y + kAtomSizePixels};
                    const double begin = threadSeconds();
                    renderer.renderRegion(rect, runs, atom, kNotCancelled);
                    const double seconds = threadSeconds() - begin;
                    for (std::size_t i = 0; i < kAtomPixels; ++i) {
                        const auto column = static_cast<std::size_t>(x) + i % kAtomSizePixels;
                        const auto row = static_cast<std::size_t>(y) + i / kAtomSizePixels;
                        const std::size_t at =
                            row * static_cast<std::size_t>(frame.width()) + column;
                        known.cost[at] += seconds / kAtomPixels / (passes * samples);
                        addPass(atom.data() + i * channels, layout, samples, sums[at]);
                    }
                }
        }
    });
    known.sampleSeconds = std::reduce(known.cost.begin(), known.cost.end());
    for (double& cost : known.cost) cost *= static_cast<double>(pixels) / known.sampleSeconds;
    for (std::size_t i = 0; i < pixels; ++i) {
        const Variances v = variancesOf(sums[i], passes);
        known.spread[i] = std::sqrt(isAlone ? v.ofPass * samples : v.within);
        known.shared += (v.ofPass - v.within / samples) / static_cast<double>(pixels);
    }
    return known;
}

std::vector<std::uint32_t> oracleSamples(const Known& known, std::uint32_t least,
                                         std::uint32_t most, double threshold) {
    std::vector<std::uint32_t> samples;
    for (std::size_t i = 0; i < known.spread.size(); ++i) {
        const double wanted = known.spread[i] / std::sqrt(known.cost[i]) / (4 * threshold);
        samples.push_back(static_cast<std::uint32_t>(std::lround(
            std::clamp(wanted, static_cast<double>(least), static_cast<double>(most)))));
    }
    return samples;
}

PassRenderer::Chooser alwaysSamples(std::vector<std::uint32_t> samples) {
    return [samples = std::move(samples)](std::uint32_t pass, std::size_t pixel, SampleRun& run) {
        run = {pass / 2 * samples[pixel], samples[pixel], 0};
    };
}

PassRenderer::Chooser samplesBySpread(const SampleRule& rule, std::vector<double> spread) {
    return
        [rule, spread = std::move(spread)](std::uint32_t pass, std::size_t pixel, SampleRun& run) {
            std::uint32_t allotted = pass;
            while (allotted > 0 && !allotsAfter(rule, allotted)) --allotted;
            const std::uint32_t samples =
                allotted > 0 ? samplesOfSpread(rule, allotted, {spread[pixel]}) : rule.least;
            run.count = static_cast<std::uint32_t>(madeUp(rule, pass, run.first, samples));
        };
}

std::vector<TimedErrors> takeTurns(const std::shared_ptr<const Scene>& scene, const Truth& truth,
                                   const std::vector<Way>& ways, std::uint64_t seed, int threads) {
    constexpr double kLonger = 1.1;
    std::vector<std::unique_ptr<PassRenderer>> renderers(ways.size());
    std::vector<TimedErrors> result(ways.size());
    std::vector<double> spent(ways.size());
    const std::uint32_t passes = ways[0].settings.passes;
    for (;;) {
        const auto i = static_cast<std::size_t>(std::ranges::min_element(spent) - spent.begin());
        const bool firstDone = result[0].errors.size() == passes;
        if (firstDone && spent[i] > kLonger * result[0].seconds.back()) return result;
        const double start = processorSeconds();
        if (!renderers[i]) {
            RenderSettings settings = ways[i].settings;
            settings.seed = seed;
            renderers[i] = std::make_unique<PassRenderer>(
                scene, settings, makePlan(*scene, settings), threads, ways[i].choose);
        }
        renderers[i]->next();
        spent[i] += processorSeconds() - start;
        result[i].errors.push_back(truth.relMse(renderers[i]->beauty()));
        result[i].seconds.push_back(spent[i]);
        // Has what it was to have: never the one with the least again.
        if (i == 0 && result[0].errors.size() == passes)
            spent[0] = 2 * kLonger * result[0].seconds.back();
    }
}

double secondsTo(double error, const TimedErrors& curve) {
    double lastError = 0, lastSeconds = 0;
    // Whoever is to tell its error has two passes.
    for (std::size_t i = 1; i < curve.errors.size(); ++i) {
        const double e = curve.errors[i], s = curve.seconds[i];
        if (i > 1 && e >= lastError) continue;
        if (e <= error) {
            if (i == 1) return s;
            const double share = std::log(lastError / error) / std::log(lastError / e);
            return lastSeconds * std::pow(s / lastSeconds, share);
        }
        lastError = e;
        lastSeconds = s;
    }
    return lastSeconds * lastError / error;
}

}  // namespace pm::bench
