// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace pm {

// Chooses one of many lights by their weights, with a floor so that none is starved.
// Threads: const functions from any, at once.
class LightChoice {
  public:
    LightChoice() = default;
    // weights: >= 0, of each light; where none is above 0 there is nothing to choose.
    explicit LightChoice(std::span<const double> weights);

    bool empty() const { return m_cumulative.empty(); }
    std::uint32_t choose(float u, float& probability) const;
    // The same; u becomes where in the light's share it lay, in [0, 1), to be used once more: what
    // is stratified over u then stays so within neighbouring lights. It has as many bits fewer as
    // the choice took.
    std::uint32_t chooseAndStretch(float& u, float& probability) const;
    float probability(std::size_t light) const { return m_probabilities[light]; }

  private:
    // Share of the choices made evenly rather than by weight: a weak lamp beside a thousand bright
    // far ones still gets its photons.
    static constexpr double kEvenShare = 0.1;

    std::vector<float> m_cumulative;  // of the probabilities, last is 1
    std::vector<float> m_probabilities;
};

inline LightChoice::LightChoice(std::span<const double> weights) {
    double total = 0;
    for (const double weight : weights) total += weight;
    if (weights.empty() || !(total > 0)) return;
    const double even = kEvenShare / static_cast<double>(weights.size());
    // A light is taken with the probability that the rounded sums leave it, whatever was meant:
    // sums in steps of the random numbers, 2^-24. One whose share is less than a step could get
    // none, so each gets at least one; with 2^24 lights and more that would be all there is.
    constexpr double kSteps = 0x1p24;
    const double atLeast = 1.0 / kSteps;
    const double scale = 1.0 - atLeast * static_cast<double>(weights.size());
    double sum = 0, before = 0;
    for (std::size_t i = 0; i < weights.size(); ++i) {
        sum += atLeast + scale * (even + (1 - kEvenShare) * weights[i] / total);
        const double rounded =
            i + 1 == weights.size() ? 1.0 : std::min(1.0, std::round(sum * kSteps) / kSteps);
        m_probabilities.push_back(static_cast<float>(rounded - before));
        m_cumulative.push_back(static_cast<float>(rounded));
        before = rounded;
    }
}

inline std::uint32_t LightChoice::choose(float u, float& probability) const {
    const auto it = std::upper_bound(m_cumulative.begin(), m_cumulative.end(), u);
    const auto index = static_cast<std::size_t>(std::min<std::ptrdiff_t>(
        it - m_cumulative.begin(), static_cast<std::ptrdiff_t>(m_cumulative.size()) - 1));
    probability = m_probabilities[index];
    return static_cast<std::uint32_t>(index);
}

inline std::uint32_t LightChoice::chooseAndStretch(float& u, float& probability) const {
    const std::uint32_t light = choose(u, probability);
    const float begin = light > 0 ? m_cumulative[light - 1] : 0.0f;
    // Half a step up, so that the mean stays 1/2 however few steps a light has.
    u = std::min((u - begin + 0x1p-25f) / probability, 0x1.fffffep-1f);
    return light;
}

}  // namespace pm
