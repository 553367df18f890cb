// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "scheduler/sample_allotment.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "integrator/values/error.h"
#include "scheduler/bucket_grid.h"
#include "scheduler/frame_error.h"

namespace pm {
namespace {

constexpr double kPassesOfALevel = 4;
constexpr std::size_t kSide = kAtomSizePixels;

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

}  // namespace

SampleRule sampleRule(std::uint32_t leastLevel, std::uint32_t mostLevel, double threshold) {
    const auto inPass = [](std::uint32_t level) {
        return level < 2 ? 0u : 1u << (2 * (level - 2));
    };
    return {inPass(leastLevel), inPass(mostLevel), threshold};
}

void checkSampleRule(const SampleRule& rule) {
    constexpr std::uint32_t kMost = 0xFFFF;
    if (rule.most < rule.least || rule.most < 1 || rule.most > kMost || !(rule.threshold > 0))
        throw Error(Status::kInvalidArgument,
                    fmt::format("{} to {} samples a pass by the threshold {}; they must be 0 to {} "
                                "and rise, the threshold above 0",
                                rule.least, rule.most, rule.threshold, kMost));
}

bool allotsAfter(std::uint32_t passes) {
    return passes >= 2 && std::has_single_bit(passes);
}

void allotSamples(const SampleRule& rule, std::span<const SeenSamples> seen,
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
        // What the neighbours met may be here, too, and not have been met yet.
        double sum = 0, count = 0;
        around(i % kSide, i / kSide, [&](std::size_t at) {
            sum += variance[at];
            ++count;
        });
        const double wanted =
            std::sqrt(std::max(variance[i], sum / count)) / (rule.threshold * kPassesOfALevel);
        // A spread that is not a number asks for nothing.
        const double most =
            std::min(std::isnan(wanted) ? 0.0 : wanted, static_cast<double>(rule.most));
        samples[i] = static_cast<std::uint16_t>(
            std::lround(std::max(most, static_cast<double>(rule.least))));
    }
}

}  // namespace pm
