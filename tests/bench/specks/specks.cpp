// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "tests/bench/specks/specks.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>

#include "tests/bench/run/timing.h"

namespace pm::bench {

namespace {

constexpr int kReach = 4;  // of the neighbours, pixels
constexpr std::size_t kFewestNeighbours = 8;
constexpr double kAlike = 2;
constexpr double kShareOfWorst = 1e-3;

struct Moments {
    std::vector<double> mean, deviation;  // of each pixel over the pictures
};

Moments momentsOf(std::span<const Values> pictures) {
    const std::size_t pixels = pictures.front().size() / 3;
    const auto n = static_cast<double>(pictures.size());
    Moments moments{std::vector<double>(pixels), std::vector<double>(pixels)};
    for (std::size_t i = 0; i < pixels; ++i) {
        const auto grey = [&](const Values& p) {
            return (p[3 * i] + p[3 * i + 1] + p[3 * i + 2]) / 3;
        };
        double mean = 0, squares = 0;
        for (const Values& p : pictures) mean += grey(p) / n;
        for (const Values& p : pictures) squares += std::pow(grey(p) - mean, 2);
        moments.mean[i] = mean;
        moments.deviation[i] = std::sqrt(squares / (n - 1));
    }
    return moments;
}

}  // namespace

Specks findSpecks(std::span<const Values> pictures, int width, int height) {
    const Moments moments = momentsOf(pictures);
    const auto at = [&](int x, int y) { return static_cast<std::size_t>(y * width + x); };
    Specks specks;
    std::vector<double> beside;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const double mean = moments.mean[at(x, y)];
            beside.clear();
            for (int v = std::max(0, y - kReach); v <= std::min(height - 1, y + kReach); ++v)
                for (int u = std::max(0, x - kReach); u <= std::min(width - 1, x + kReach); ++u) {
                    const double other = moments.mean[at(u, v)];
                    if ((u != x || v != y) && other <= kAlike * mean && mean <= kAlike * other)
                        beside.push_back(moments.deviation[at(u, v)]);
                }
            if (beside.size() < kFewestNeighbours) continue;
            specks.judged += 1.0 / (static_cast<double>(width) * height);
            const double own = moments.deviation[at(x, y)], usual = spreadOf(beside).median;
            if (own == 0) continue;
            // What doesn't vary but for rounding is as good as even.
            const double ratio = own / std::max(usual, 1e-6 * mean);
            specks.count += ratio > kSpeckRatio;
            if (ratio > specks.worstRatio) {
                specks.worstRatio = ratio;
                specks.x = x;
                specks.y = y;
            }
        }
    return specks;
}

PairError errorOfPair(const Values& a, const Values& b) {
    std::vector<double> errors(a.size() / 3);
    for (std::size_t i = 0; i < a.size(); ++i) {
        const double m = (a[i] + b[i]) / 2;
        errors[i / 3] += (a[i] - b[i]) * (a[i] - b[i]) / (2 * (m * m + 0.01)) / 3;
    }
    const double sum = std::reduce(errors.begin(), errors.end());
    const auto worst = static_cast<std::ptrdiff_t>(
        std::max(1.0, std::round(kShareOfWorst * static_cast<double>(errors.size()))));
    std::nth_element(errors.begin(), errors.begin() + worst, errors.end(), std::greater<>());
    const double ofWorst = std::reduce(errors.begin(), errors.begin() + worst);
    return {sum / static_cast<double>(errors.size()), sum > 0 ? ofWorst / sum : 0};
}

}  // namespace pm::bench
