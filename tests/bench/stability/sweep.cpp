// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "tests/bench/stability/sweep.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "tests/support/replicates.h"
#include "tests/support/statistics.h"

namespace pm::bench {

bool SweepResult::isFlat(double limit) const {
    return std::ranges::none_of(points, [&](const SweepPoint& point) {
        return sweep.hasToBeFlatAt(point.value) && !(point.z <= limit);
    });
}

const SweepPoint& SweepResult::worst() const {
    const SweepPoint* worst = nullptr;
    for (const SweepPoint& point : points) {
        if (!sweep.hasToBeFlatAt(point.value)) continue;
        const auto rank = [](const SweepPoint& p) { return std::pair(p.z, std::abs(p.error)); };
        if (!worst || rank(point) > rank(*worst)) worst = &point;
    }
    return worst ? *worst : points.front();
}

namespace {

// One value: what is seen with each seed, and what should be.
SweepPoint pointOf(const Sweep& sweep, double value, const std::vector<double>& seen,
                   const std::vector<double>& expected) {
    const auto count = static_cast<std::uint32_t>(seen.size());
    SweepPoint point;
    point.value = value;
    point.measured = test::momentsOf(count, [&](std::uint32_t i) { return seen[i]; }).mean;
    point.expected = test::momentsOf(count, [&](std::uint32_t i) { return expected[i]; }).mean;
    const double scale = sweep.isCount ? 1 : std::abs(point.expected);
    // Of the differences, seed by seed: a twin of the same seed may share its noise.
    const test::Moments off =
        test::momentsOf(count, [&](std::uint32_t i) { return (seen[i] - expected[i]) / scale; });
    point.error = off.mean;
    point.standardError = std::sqrt(off.variance / (count - 1));
    const int seeds = static_cast<int>(count);
    point.z = test::zScore({off.mean, point.standardError, seeds}, {0, 0, seeds}, kSweepRounding);
    // NaN is no number of standard errors, and no fault is chance.
    if (!std::isfinite(point.measured) || (sweep.isCount && point.measured > 0))
        point.z = std::numeric_limits<double>::infinity();
    return point;
}

}  // namespace

SweepResult run(const Sweep& sweep, int seeds) {
    const auto each = [&](const auto& number) {
        std::vector<double> numbers(static_cast<std::size_t>(seeds));
        tbb::parallel_for(std::size_t{0}, numbers.size(), [&](std::size_t i) {
            numbers[i] = number(test::firstSeed() + static_cast<std::uint64_t>(i));
        });
        return numbers;
    };
    std::vector<double> twin;
    if (sweep.wellAt)
        twin = each([&](std::uint64_t seed) { return sweep.measure(*sweep.wellAt, seed); });
    SweepResult result{sweep, seeds, {}};
    for (const double value : sweep.values) {
        std::vector<double> expected = twin;
        if (!sweep.wellAt)
            expected = each([&](std::uint64_t seed) {
                return sweep.isCount ? 0 : sweep.expected(value, seed);
            });
        const auto seen = each([&](std::uint64_t seed) { return sweep.measure(value, seed); });
        result.points.push_back(pointOf(sweep, value, seen, expected));
    }
    return result;
}

Sweep shortened(Sweep sweep) {
    std::vector<double> flat;
    std::ranges::copy_if(sweep.values, std::back_inserter(flat),
                         [&](double value) { return sweep.hasToBeFlatAt(value); });
    if (flat.size() > 3) flat = {flat.front(), flat[flat.size() / 2], flat.back()};
    sweep.values = flat;
    return sweep;
}

double limitOfChance(std::size_t count) {
    double low = 0, high = 40;
    while (high - low > 1e-9) {
        const double middle = (low + high) / 2;
        const double chance = std::erfc(middle / std::sqrt(2.0)) * static_cast<double>(count);
        (chance > 0.01 ? low : high) = middle;
    }
    return high;
}

std::vector<double> decades(int first, int last, int perDecade) {
    std::vector<double> values;
    const int step = first <= last ? 1 : -1;
    for (int i = first * perDecade; i != last * perDecade + step; i += step)
        values.push_back(std::pow(10.0, static_cast<double>(i) / perDecade));
    return values;
}

std::vector<Sweep> allSweeps() {
    std::vector<Sweep> all;
    for (const auto& sweeps : {placementSweeps(), shellSweeps(), lightSweeps(), glassSweeps(),
                               lobeSweeps(), photonSweeps()})
        all.insert(all.end(), sweeps.begin(), sweeps.end());
    return all;
}

}  // namespace pm::bench
