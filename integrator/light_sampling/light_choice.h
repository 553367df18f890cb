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

    // As many cells of [0, 1] as lights: the one that a number lies in says about where to look.
    std::size_t cellOf(float u) const {
        const auto cell = static_cast<double>(u) * static_cast<double>(m_cumulative.size());
        return std::min(static_cast<std::size_t>(cell), m_cumulative.size() - 1);
    }

    std::vector<float> m_cumulative;  // of the probabilities, last is 1
    std::vector<float> m_probabilities;
    std::vector<std::uint32_t> m_firsts;  // of each cell: the light in whose share it begins
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
    m_firsts.assign(weights.size() + 1, static_cast<std::uint32_t>(weights.size() - 1));
    // Down to the light in whose share a cell begins or that begins within it.
    for (std::size_t i = weights.size(); i-- > 0;) {
        const float begin = i > 0 ? m_cumulative[i - 1] : 0.0f;
        for (std::size_t cell = cellOf(begin); cell <= cellOf(m_cumulative[i]); ++cell)
            m_firsts[cell] = static_cast<std::uint32_t>(i);
    }
}

inline std::uint32_t LightChoice::choose(float u, float& probability) const {
    const std::size_t cell = cellOf(u);
    const auto first = m_cumulative.begin();
    // The last light that is looked at need not be compared with.
    const auto index = static_cast<std::size_t>(
        std::upper_bound(first + m_firsts[cell], first + m_firsts[cell + 1], u) - first);
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
