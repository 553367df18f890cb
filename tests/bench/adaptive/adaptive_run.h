// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Renders whose times to an error are held against each other: of a fixed level, adaptive ones, and
// those of an oracle that knows each pixel's variance beforehand.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "integrator/scene/scene.h"
#include "integrator/transport/frame/render_settings.h"
#include "scheduler/film/sample_allotment.h"
#include "tests/bench/run/pass_renderer.h"

namespace pm::bench {

// Two renders that share no noise, RGB, row by row: in the products of what a picture differs from
// them by, their own noise cancels on the average.
struct Truth {
    std::vector<double> first, second;

    double relMse(std::span<const double> picture) const;
    double ownNoise() const;  // relMSE of their mean
};

// passes: of 256 samples for paths, of 16 for photons with narrow estimates.
Truth makeTruth(const std::shared_ptr<const Scene>& scene, std::int32_t size, bool byPaths,
                std::uint32_t passes, int threads);

// What the oracle knows of a pixel, row by row.
struct Known {
    // Relative standard deviation of a sample, beside what a pass shares; where it shares nothing,
    // twice that of the mean of four samples, which knows what low-discrepancy sequences cure.
    std::vector<double> spread;
    std::vector<double> cost;  // of a sample over the frame's mean, by 8 x 8 pixels
    double shared = 0;         // relMSE of a pass with any number of samples, about
    double sampleSeconds = 0;  // of processor time: of a sample of all pixels
    double passSeconds = 0;    // of photons and maps
};
Known measureKnown(const std::shared_ptr<const Scene>& scene, const RenderSettings& settings,
                   std::uint32_t passes, int threads);

// The oracle's samples a pass, where N is the spread of a pixel over 4 thresholds, and dear samples
// are fewer: the least sum of squared errors for the time.
std::vector<std::uint32_t> oracleSamples(const Known& known, std::uint32_t least,
                                         std::uint32_t most, double threshold);

// Those in every pass of a fixed level.
PassRenderer::Chooser alwaysSamples(std::vector<std::uint32_t> samples);

// The samples of an adaptive render that knows each pixel's spread, and otherwise obeys the rule,
// the first pass with the least included.
PassRenderer::Chooser samplesBySpread(const SampleRule& rule, std::vector<double> spread);

// One way to render. choose: empty: as the settings say.
struct Way {
    RenderSettings settings;
    PassRenderer::Chooser choose;
};

// relMSE and processor seconds so far, after each pass.
struct TimedErrors {
    std::vector<double> errors, seconds;
};

// One seed of all ways. The one that has spent least makes its next pass, so that a slow moment of
// the machine meets all, until the first has made all passes of its settings, and each of the
// others has spent a tenth more than that.
std::vector<TimedErrors> takeTurns(const std::shared_ptr<const Scene>& scene, const Truth& truth,
                                   const std::vector<Way>& ways, std::uint64_t seed, int threads);

// Seconds to an error on the straight line between the logarithms of the points of least error so
// far, from the second pass on; beyond the last point as if time times error stayed; before the
// first, the first.
double secondsTo(double error, const TimedErrors& curve);

}  // namespace pm::bench
