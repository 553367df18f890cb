// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "tests/support/statistics.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace pm::test {

namespace {

// The regularised upper incomplete gamma function Q(a, x), by series or by continued fraction
// (Lentz). Source: Abramowitz & Stegun 6.5.29 and 6.5.31.
double upperGamma(double a, double x) {
    if (x <= 0) return 1;
    const double factor = std::exp(a * std::log(x) - x - std::lgamma(a));
    if (x < a + 1) {
        double term = 1 / a, sum = term;
        for (double n = a + 1; term > 1e-16 * sum; ++n) sum += term *= x / n;
        return 1 - factor * sum;
    }
    double b = x + 1 - a, c = 1e300, d = 1 / b, h = d;
    for (int i = 1; i < 10000; ++i) {
        const double an = -i * (i - a);
        b += 2;
        d = 1 / (an * d + b);
        c = b + an / c;
        h *= c * d;
        if (std::abs(c * d - 1) < 1e-14) break;
    }
    return factor * h;
}

}  // namespace

double chiSquaredPValue(double statistic, double degreesOfFreedom) {
    return upperGamma(0.5 * degreesOfFreedom, 0.5 * statistic);
}

double Histogram::pValue(double missed) const {
    double total = missed, probability = 0;
    for (std::size_t i = 0; i < m_counts.size(); ++i) {
        total += m_counts[i];
        probability += m_probabilities[i];
    }
    double pooledCount = missed;
    double pooledExpected = std::max(0.0, 1 - probability) * total;
    double statistic = 0;
    int bins = 0;
    const auto take = [&](double count, double expected) {
        statistic += (count - expected) * (count - expected) / expected;
        ++bins;
    };
    for (std::size_t i = 0; i < m_counts.size(); ++i) {
        const double expected = m_probabilities[i] * total;
        if (expected >= 5) {
            take(m_counts[i], expected);
        } else {
            pooledCount += m_counts[i];
            pooledExpected += expected;
        }
    }
    // Almost nothing is expected there: then nothing should be seen but what the integration of
    // the density left over.
    if (pooledExpected < 5) {
        if (pooledCount > 30) return 0;
    } else {
        take(pooledCount, pooledExpected);
    }
    return chiSquaredPValue(statistic, bins - 1);
}

double DirectionTest::pValue(const std::function<std::optional<Vec3f>()>& sample,
                             const std::function<double(const Vec3f&)>& density) const {
    const Frame frame(axis);
    Histogram histogram(static_cast<std::size_t>(cosineBins * turnBins));
    const double range = 1 - smallestCosine;
    const int rows = cosineBins * subdivisions, columns = turnBins * subdivisions;
    const double solidAngle = 2 * std::numbers::pi * range / rows / columns;
    for (int j = 0; j < rows; ++j)
        for (int i = 0; i < columns; ++i) {
            const double z = smallestCosine + range * (j + 0.5) / rows;
            const double r = std::sqrt(std::max(0.0, 1 - z * z));
            const double phi = 2 * std::numbers::pi * (i + 0.5) / columns;
            const Vec3f local(Vec3d{r * std::cos(phi), r * std::sin(phi), z});
            histogram.expect(
                static_cast<std::size_t>(j / subdivisions * turnBins + i / subdivisions),
                density(frame.toWorld(local)) * solidAngle);
        }
    double missed = 0;
    for (int n = 0; n < samples; ++n) {
        const std::optional<Vec3f> direction = sample();
        const Vec3f d = direction.value_or(Vec3f{});
        const double z = static_cast<double>(dot(d, frame.normal));
        if (!direction || z < smallestCosine - 1e-6) {
            ++missed;
            continue;
        }
        double turns = std::atan2(static_cast<double>(dot(d, frame.bitangent)),
                                  static_cast<double>(dot(d, frame.tangent))) /
                       (2 * std::numbers::pi);
        turns -= std::floor(turns);
        const int row = std::clamp(static_cast<int>((z - smallestCosine) / range * cosineBins), 0,
                                   cosineBins - 1);
        const int column = std::min(static_cast<int>(turns * turnBins), turnBins - 1);
        histogram.count(static_cast<std::size_t>(row * turnBins + column));
    }
    return histogram.pValue(missed);
}

double squarePValue(int samples, const std::function<std::optional<Vec2f>()>& sample,
                    const std::function<double(double, double)>& density) {
    constexpr int kBins = 16, kSubdivisions = 16, kRows = kBins * kSubdivisions;
    Histogram histogram(kBins * kBins);
    for (int j = 0; j < kRows; ++j)
        for (int i = 0; i < kRows; ++i)
            histogram.expect(
                static_cast<std::size_t>(j / kSubdivisions * kBins + i / kSubdivisions),
                density((i + 0.5) / kRows, (j + 0.5) / kRows) / (kRows * kRows));
    double missed = 0;
    for (int n = 0; n < samples; ++n) {
        const std::optional<Vec2f> point = sample();
        if (!point) {
            ++missed;
            continue;
        }
        const auto bin = [](float v) {
            return static_cast<std::size_t>(std::clamp(static_cast<int>(v * kBins), 0, kBins - 1));
        };
        histogram.count(bin(point->y) * kBins + bin(point->x));
    }
    return histogram.pValue(missed);
}

}  // namespace pm::test
