// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Numerical stability: a number that should not change with a parameter, over the parameter.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace pm::bench {

struct Sweep {
    std::string kind{};       // a chapter of the page
    std::string name{};       // sweeps of one name and kind share a plot
    std::string variant{};    // what tells those apart: photon, path
    std::string parameter{};  // of the plot's axis
    std::vector<double> values{};
    std::string against{};  // what it is held against, in words
    // Users of other renderers met it: repository and number of the issue.
    std::string reported{};

    // What one render shows, or a number of faults; renders of unlike seeds are independent.
    using Number = std::function<double(double value, std::uint64_t seed)>;
    Number measure{};
    // What that should be: the twin, or a closed form.
    Number expected{};
    // In place of that: measure() where all is well-conditioned.
    std::optional<double> wellAt{};
    bool isCount = false;  // of faults, of which there are to be none

    // Within these, and at flatAlso, it is to be flat; beyond is the limit, in words.
    double flatFrom = -std::numeric_limits<double>::infinity();
    double flatTo = std::numeric_limits<double>::infinity();
    std::optional<double> flatAlso{};
    std::string limit{};
    // Too slow for the suite.
    bool isLong = false;

    bool hasToBeFlatAt(double value) const {
        return (value >= flatFrom && value <= flatTo) || value == flatAlso;
    }
};

struct SweepPoint {
    double value = 0;
    double measured = 0, expected = 0;  // means over the seeds
    double error = 0;                   // relative to what is expected; of counts the count
    double standardError = 0;           // of `error`, from the spread between seeds
    // `error` in standard errors, beyond rounding, as the normal number that is as rare.
    double z = 0;
};

struct SweepResult {
    Sweep sweep;
    int seeds = 0;
    std::vector<SweepPoint> points;

    // Whether no point that has to be flat is beyond so many standard errors.
    bool isFlat(double limit) const;
    // The point that has to be flat with the largest z; of equals that with the largest error.
    // Where none has to be, the first.
    const SweepPoint& worst() const;
};

// What sums of floats along a path may be off by, relative: 64 roundings.
inline constexpr double kSweepRounding = 64 * 0x1p-24;

// seeds: >= 2, at each value.
SweepResult run(const Sweep& sweep, int seeds);

// The two ends, the middle, and the last values within which the sweep has to be flat.
Sweep shortened(Sweep sweep);

// Beyond which chance brings one of so many normal numbers once in a hundred times.
double limitOfChance(std::size_t count);

// Powers of ten from 10^first to 10^last, up or down, `perDecade` in each.
std::vector<double> decades(int first, int last, int perDecade = 1);

// Of each kind, in their files.
std::vector<Sweep> placementSweeps();
std::vector<Sweep> shellSweeps();
std::vector<Sweep> lightSweeps();
std::vector<Sweep> glassSweeps();
std::vector<Sweep> lobeSweeps();
std::vector<Sweep> photonSweeps();
std::vector<Sweep> allSweeps();

}  // namespace pm::bench
