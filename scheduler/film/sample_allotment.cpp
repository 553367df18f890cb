// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "scheduler/film/sample_allotment.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

#include "integrator/values/error.h"

namespace pm {
namespace {

constexpr double kPassesOfALevel = 4;
// Those of level 3 in four passes, which errors are told by then.
constexpr double kSamplesOfReference = 16;
// What the neighbours met may be here, too, and not have been met yet: they count as so many
// samples of the pixel's own.
constexpr double kSamplesOfNeighbours = 3;
// In four passes; see isDivided().
constexpr double kSamplesThatDivide = 16;
// More than the least gets who wants more than so many times the least: samples that are all alike
// are worth more than their number.
constexpr double kBeyondLeast = 1.7;
// Samples of a pass that tempering leaves as they are; and the largest spread that it tempers,
// that of edges once there are two passes.
constexpr double kAsKnown = 6, kMostTempered = 0.7, kMostTemperedOfEdge = 0.25;
// A pass makes up for what earlier ones lacked by at most so many times what is allotted.
constexpr double kMostMadeUp = 2;
// Samples of the second pass where nothing is shared: the first has seen little, and where all is
// noisy one much larger pass is as good as none before.
constexpr std::uint32_t kMostOfSecond = 16;

// What the threshold is divided by. A few samples show little, and what is spent by them is lost
// where they mislead.
double finer(std::uint32_t passes) {
    return passes < 2 ? 1 : passes < 4 ? 2 : 2 * std::numbers::sqrt2;
}

// Samples of a pass for what would be so many if their spread were known and noise went down like
// 1 / N: more where that is few, less where it is many, since few samples tell badly which pixels
// are which, and a low-discrepancy sequence cures an edge by itself. Not light that few samples
// meet, whose spread is large: no sequence cures that.
double tempered(double inPass, std::uint32_t passes, const PixelSpread& spread) {
    const double most = spread.hasEdge && passes >= 2 ? kMostTemperedOfEdge : kMostTempered;
    const double rare = std::max(1.0, spread.ofSamples / most);
    return rare * std::sqrt(kAsKnown * inPass / rare);
}

// The same where the samples of a pass share no noise.
double finerAlone(std::uint32_t passes) {
    return passes < 2 ? 3 : passes < 4 ? 11 : 24;
}

// Where nothing is shared the error of N samples of a low-discrepancy sequence falls like N^-p,
// p = 5/3 about, and 2 / (p + 1) is 3/4. By square roots, which are the same everywhere.
double toThreeQuarters(double x) {
    return std::sqrt(x) * std::sqrt(std::sqrt(x));
}

// The nearest power of two, by its ratio.
std::uint32_t nearestPower(double wanted, std::uint32_t most) {
    std::uint32_t power = 1;
    while (power < most && power * std::numbers::sqrt2 < wanted) power *= 2;
    return power;
}

// The nearest of 1, 2, 3, 4, 6, 8, 12, 16, ...
std::uint32_t nearestStep(double wanted, std::uint32_t most) {
    std::uint32_t power = 1;
    while (power < most && power * std::numbers::sqrt3 < wanted) power *= 2;
    return power > 1 && power * std::sqrt(1.5) < wanted ? power / 2 * 3 : power;
}

}  // namespace

SampleRule sampleRule(std::uint32_t leastLevel, std::uint32_t mostLevel, double threshold,
                      bool sharesNoise) {
    const auto inPass = [](std::uint32_t level) {
        return level < 2 ? 0u : 1u << (2 * (level - 2));
    };
    return {inPass(leastLevel), inPass(mostLevel), threshold, leastLevel == 0, sharesNoise};
}

void checkSampleRule(const SampleRule& rule) {
    constexpr std::uint32_t kMost = 0xFFFF;
    const std::uint32_t leastMost = rule.groups ? 0 : 1;
    if (rule.most < rule.least || rule.most < leastMost || rule.most > kMost ||
        !(rule.threshold > 0))
        throw Error(Status::kInvalidArgument,
                    fmt::format("{} to {} samples a pass by the threshold {}; they must be 0 to {} "
                                "and rise, the threshold above 0",
                                rule.least, rule.most, rule.threshold, kMost));
}

bool isDivided(const SampleRule& rule, const SeenSamples& even, const SeenSamples& odd) {
    SeenSamples both = even;
    both.samples += odd.samples;
    for (std::size_t c = 0; c < 3; ++c) both.sums[c] += odd.sums[c];
    both.square += odd.square;
    // Also where it is not a number.
    return !(std::sqrt(relativeVariance(both, rule.errorScale.offset())) <=
             kSamplesThatDivide * rule.threshold);
}

bool allotsAfter(const SampleRule& rule, std::uint32_t passes) {
    return !rule.isAlone() || std::has_single_bit(passes);
}

std::uint16_t samplesOfSpread(const SampleRule& rule, std::uint32_t passes,
                              const PixelSpread& spread) {
    double inPass = spread.ofSamples / rule.threshold / kPassesOfALevel;
    if (!rule.isAlone()) {
        inPass *= finer(passes);
        // Not the least of both, which makes a number of what is none.
        if (spread.shared * inPass > spread.ofSamples) inPass = spread.ofSamples / spread.shared;
        inPass = tempered(inPass, passes, spread);
        // A number that is none asks for nothing.
        const std::uint32_t power = inPass >= 0.5 ? nearestPower(inPass, rule.most) : 0;
        return static_cast<std::uint16_t>(std::clamp(power, rule.least, rule.most));
    }
    constexpr double kReference = kSamplesOfReference / kPassesOfALevel;
    inPass = kReference * toThreeQuarters(finerAlone(passes) * inPass / kReference);
    const bool isMore = inPass > kBeyondLeast * rule.least;
    const std::uint32_t step = isMore ? nearestStep(inPass, rule.most) : rule.least;
    const std::uint32_t most = passes < 2 ? std::min(kMostOfSecond, rule.most) : rule.most;
    return static_cast<std::uint16_t>(std::max(rule.least, std::min(step, most)));
}

double madeUp(const SampleRule& rule, std::uint32_t pass, double had, double allotted) {
    if (!rule.isAlone()) return allotted;
    const std::uint32_t passesOfHalf = pass / 2 + 1;
    const double lacking = allotted * passesOfHalf - had;
    return std::max(static_cast<double>(rule.least), std::min(lacking, kMostMadeUp * allotted));
}

void allotSamples(const SampleRule& rule, std::uint32_t passes,
                  std::span<const SeenSamples, kAtomPixels> seen, std::span<std::uint16_t> samples,
                  std::span<std::uint16_t> weights) {
    const AtomNoise noise(seen, rule.errorScale);
    const double shared = rule.isAlone() ? 0 : std::sqrt(noise.shared(rule.least));
    for (std::size_t i = 0; i < kAtomPixels; ++i) {
        if (!rule.isAlone()) {
            const double variance = noise.ofPixel(i, kSamplesOfNeighbours);
            samples[i] =
                samplesOfSpread(rule, passes, {std::sqrt(variance), shared, seen[i].edges > 0});
            continue;
        }
        const auto [byAll, byOthers] = noise.evened(i);
        samples[i] = samplesOfSpread(rule, passes, {std::sqrt(byAll)});
        if (!weights.empty()) weights[i] = samplesOfSpread(rule, passes, {std::sqrt(byOthers)});
    }
}

}  // namespace pm
