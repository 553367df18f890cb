// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "scheduler/sample_allotment.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numbers>

#include "integrator/values/error.h"
#include "scheduler/bucket_grid.h"
#include "scheduler/frame_error.h"

namespace pm {
namespace {

constexpr double kPassesOfALevel = 4;
// What one or two passes show is little; from four on the threshold is divided by this.
constexpr double kFiner = 2;
// Where the samples of a pass share no noise: the threshold is divided by this as well.
constexpr double kFinerAlone = 2;
// Those of level 3 in four passes, which errors are told by then.
constexpr double kSamplesOfReference = 16;
// What the neighbours met may be here, too, and not have been met yet: they count as so many
// samples of the pixel's own.
constexpr double kSamplesOfNeighbours = 3;
// In four passes; see isDivided().
constexpr double kSamplesThatDivide = 16;
constexpr std::size_t kSide = kAtomSizePixels;

// Where nothing is shared the error of N samples of a low-discrepancy sequence falls like N^-p,
// p = 5/3 about, and 2 / (p + 1) is 3/4. By square roots, which are the same everywhere.
double toThreeQuarters(double x) {
    return std::sqrt(x) * std::sqrt(std::sqrt(x));
}

// Calls visit with each pixel of the 3 x 3 around (x, y) that lies in the atom.
template <typename Visit>
void around(std::size_t x, std::size_t y, Visit visit) {
    for (std::size_t j = y - std::min<std::size_t>(y, 1); j <= std::min(kSide - 1, y + 1); ++j)
        for (std::size_t i = x - std::min<std::size_t>(x, 1); i <= std::min(kSide - 1, x + 1); ++i)
            visit(j * kSide + i);
}

// Relative variance of samples taken together: those of one pixel, or of several.
class Spread {
  public:
    void add(const SeenSamples& seen) {
        m_samples += seen.samples;
        for (std::size_t c = 0; c < 3; ++c) m_sums[c] += seen.sums[c];
        m_square += seen.square;
    }
    double variance() const {
        if (!(m_samples > 1)) return 0;
        double ofMean = 0;
        for (const double sum : m_sums) ofMean += (sum / m_samples) * (sum / m_samples);
        const double apart = std::max(0.0, m_square / m_samples - ofMean);
        return apart * m_samples / (m_samples - 1) / (ofMean + 3 * kRelMseOffset);
    }

  private:
    double m_samples = 0, m_sums[3]{}, m_square = 0;
};

// What the pixels around this one lead to expect: half of it what those show by themselves, half by
// what they differ from each other, since an edge between two pixels mostly cuts one of them. Given
// are the pixels' variances.
double varianceAround(std::size_t pixel, std::span<const SeenSamples> seen,
                      std::span<const double> variance) {
    Spread together;
    double sum = 0, count = 0;
    around(pixel % kSide, pixel / kSide, [&](std::size_t at) {
        together.add(seen[at]);
        sum += variance[at];
        ++count;
    });
    return (sum / count + together.variance()) / 2;
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

bool allotsAfter(std::uint32_t passes) {
    return std::has_single_bit(passes);
}

bool isDivided(const SampleRule& rule, const SeenSamples& even, const SeenSamples& odd) {
    Spread spread;
    spread.add(even);
    spread.add(odd);
    // Also where it is not a number.
    return !(std::sqrt(spread.variance()) <= kSamplesThatDivide * rule.threshold);
}

std::uint16_t samplesOfSpread(const SampleRule& rule, std::uint32_t passes, double spread) {
    double wanted = spread / rule.threshold * (passes < 4 ? 1 : kFiner);
    if (!rule.sharesNoise)
        wanted = kSamplesOfReference * toThreeQuarters(kFinerAlone * wanted / kSamplesOfReference);
    const double inPass = wanted / kPassesOfALevel;
    // A number that is none asks for nothing.
    std::uint32_t power = inPass >= 0.5 ? 1 : 0;
    while (power > 0 && power < rule.most && power * std::numbers::sqrt2 < inPass) power *= 2;
    return static_cast<std::uint16_t>(std::clamp(power, rule.least, rule.most));
}

void allotSamples(const SampleRule& rule, std::uint32_t passes, std::span<const SeenSamples> seen,
                  std::span<std::uint16_t> samples) {
    std::array<double, kSide * kSide> variance{};
    for (std::size_t i = 0; i < variance.size(); ++i) {
        Spread spread;
        // One sample has no spread: then what is around it stands in.
        if (seen[i].samples > 1)
            spread.add(seen[i]);
        else
            around(i % kSide, i / kSide, [&](std::size_t at) { spread.add(seen[at]); });
        variance[i] = spread.variance();
    }
    for (std::size_t i = 0; i < variance.size(); ++i) {
        const double own = seen[i].samples;
        const double pooled =
            (own * variance[i] + kSamplesOfNeighbours * varianceAround(i, seen, variance)) /
            (own + kSamplesOfNeighbours);
        samples[i] = samplesOfSpread(rule, passes, std::sqrt(pooled));
    }
}

}  // namespace pm
