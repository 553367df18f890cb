// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <random>
#include <vector>

#include "integrator/sampling/warps.h"
#include "integrator/values/vec.h"

namespace pm::test {

// Independent random numbers with the same bits on every machine (a stratified sampler would make
// chi-squared statistics too small).
class Random {
  public:
    explicit Random(std::uint64_t seed) : m_engine(seed) {}
    float next() { return static_cast<float>(m_engine() >> 40) * 0x1p-24f; }
    Vec2f next2D() {
        const float x = next();
        return {x, next()};
    }

  private:
    std::mt19937_64 m_engine;
};

// Of independent numbers: mean, variance of one of them, standard error of the mean.
struct Moments {
    double mean = 0, variance = 0, standardError = 0;
};

// number: the i-th of `count`, >= 1.
template <typename Number>
Moments momentsOf(std::uint32_t count, const Number& number) {
    double sum = 0, squares = 0;
    for (std::uint32_t i = 0; i < count; ++i) {
        const double value = number(i);
        sum += value;
        squares += value * value;
    }
    const double mean = sum / count;
    const double variance = std::max(0.0, squares / count - mean * mean);  // rounded
    return {mean, variance, std::sqrt(variance / count)};
}

// Probability that a chi-squared variable with so many degrees of freedom exceeds the statistic.
double chiSquaredPValue(double statistic, double degreesOfFreedom);

// Counts of events against the probabilities that they should have.
class Histogram {
  public:
    explicit Histogram(std::size_t bins) : m_counts(bins), m_probabilities(bins) {}
    void count(std::size_t bin) { m_counts[bin] += 1; }
    void expect(std::size_t bin, double probability) { m_probabilities[bin] += probability; }

    // Of Pearson's test; what the probabilities lack of 1 is expected of `missed` events. Bins
    // where fewer than 5 events are expected are taken together.
    double pValue(double missed) const;

  private:
    std::vector<double> m_counts, m_probabilities;
};

// Tests directions against a density over solid angle.
struct DirectionTest {
    Vec3f axis{0.0f, 0.0f, 1.0f};
    double smallestCosine = -1;  // to the axis; directions beyond count as missed
    int cosineBins = 16, turnBins = 32, subdivisions = 24;
    int samples = 400'000;

    // sample: nothing when the sample is refused. density: sr^-1, of unit directions.
    double pValue(const std::function<std::optional<Vec3f>()>& sample,
                  const std::function<double(const Vec3f&)>& density) const;
};

// Tests points of the unit square against a density over it.
double squarePValue(int samples, const std::function<std::optional<Vec2f>()>& sample,
                    const std::function<double(double, double)>& density);

}  // namespace pm::test
