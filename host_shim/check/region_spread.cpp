// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/check/region_spread.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "host_shim/values/host_error.h"

namespace pm::host {
namespace {

constexpr std::array<const char*, 3> kChannels{"R", "G", "B"};

// Floats that were summed in another order may differ by that of the value.
constexpr double kRounding = 1e-6;
// Of one picture: that chance alone brings any of its regions beyond the limit.
constexpr double kFalseAlarm = 1e-6;
constexpr double kBeyondOwn = 1.5;
// Where all other renders agree to the bit any difference is beyond all limits.
constexpr double kMostLimit = 100;

// The probability that |T| > t, T Student's with so many degrees of freedom; by the finite series
// of Abramowitz and Stegun 26.7.3 and 26.7.4.
double tailOfStudent(double t, std::int32_t degrees) {
    const double theta = std::atan(t / std::sqrt(degrees));
    const double cosine = std::cos(theta), square = cosine * cosine;
    const bool isOdd = degrees % 2 != 0;
    double term = isOdd ? cosine : 1.0, sum = degrees == 1 ? 0.0 : term;
    for (std::int32_t k = isOdd ? 3 : 2; k <= degrees - 2; k += 2) {
        term *= square * (k - 1.0) / k;
        sum += term;
    }
    const double part = std::sin(theta) * sum;
    return 1 - (isOdd ? 2 / std::numbers::pi * (theta + part) : part);
}

// Beyond which one of `count` numbers as Student's t is found with the probability.
double limitOfStudent(double probability, std::size_t count, std::int32_t degrees) {
    const double each = probability / static_cast<double>(count);
    double low = 0, high = 1;
    while (high < 1e6 && tailOfStudent(high, degrees) > each) high *= 2;
    for (int i = 0; i < 60; ++i) {
        const double middle = (low + high) / 2;
        (tailOfStudent(middle, degrees) > each ? low : high) = middle;
    }
    return high;
}

// Of a render's mean against that of the others.
std::vector<double> variancesOf(const RegionSpread& spread) {
    std::vector<double> result = spread.variance;
    const double ofMean = 1.0 + 1.0 / spread.renders;
    for (std::size_t i = 0; i < result.size(); ++i) {
        const double rounding = kRounding * spread.mean[i];
        result[i] = result[i] * ofMean + rounding * rounding;
    }
    return result;
}

// Nothing is farther off than NaN.
bool isFarther(double a, double b) {
    if (std::isnan(a) || std::isnan(b)) return std::isnan(a) && !std::isnan(b);
    return std::abs(a) > std::abs(b);
}

void measure(RegionSpread& spread, const std::vector<std::vector<double>>& means,
             std::size_t without) {
    const std::size_t count = means.size() - (without < means.size() ? 1 : 0);
    spread.renders = static_cast<std::int32_t>(count);
    spread.mean.assign(means.front().size(), 0.0);
    spread.variance.assign(means.front().size(), 0.0);
    for (std::size_t i = 0; i < spread.mean.size(); ++i) {
        double sum = 0, squares = 0;
        for (std::size_t k = 0; k < means.size(); ++k)
            if (k != without) sum += means[k][i];
        const double mean = sum / static_cast<double>(count);
        for (std::size_t k = 0; k < means.size(); ++k)
            if (k != without) squares += (means[k][i] - mean) * (means[k][i] - mean);
        spread.mean[i] = mean;
        spread.variance[i] = squares / static_cast<double>(count - 1);
    }
}

}  // namespace

Beauty beautyOf(const Picture& picture) {
    Beauty beauty{picture.dataWindow, {}};
    for (std::size_t c = 0; c < 3; ++c) {
        const Channel* channel = picture.find(kChannels[c]);
        if (channel == nullptr)
            throw HostError(ExitCode::kBadInput,
                            fmt::format("the picture has no channel {}; R, G and B are compared",
                                        kChannels[c]));
        beauty.values[c] = channel->values;
    }
    return beauty;
}

RegionGrid::RegionGrid(const PixelRect& window, std::int32_t side)
    : m_window(window), m_side(side == 0 ? std::max(window.width(), window.height()) : side) {
    m_columns = (window.width() + m_side - 1) / m_side;
    m_rows = (window.height() + m_side - 1) / m_side;
}

PixelRect RegionGrid::rect(std::int32_t column, std::int32_t row) const {
    const std::int32_t x0 = m_window.x0 + column * m_side, y0 = m_window.y0 + row * m_side;
    return {x0, y0, std::min(x0 + m_side, m_window.x1), std::min(y0 + m_side, m_window.y1)};
}

PixelRect RegionGrid::rectOf(std::size_t region) const {
    const auto index = static_cast<std::int32_t>(region);
    return rect(index % m_columns, index / m_columns);
}

std::vector<double> RegionGrid::means(const Beauty& picture) const {
    std::vector<double> result;
    const auto width = static_cast<std::size_t>(m_window.width());
    for (std::int32_t row = 0; row < m_rows; ++row) {
        for (std::int32_t column = 0; column < m_columns; ++column) {
            const PixelRect area = rect(column, row);
            for (const std::span<const float> values : picture.values) {
                double sum = 0;
                for (std::int32_t y = area.y0; y < area.y1; ++y) {
                    const auto line = static_cast<std::size_t>(y - m_window.y0) * width;
                    for (std::int32_t x = area.x0; x < area.x1; ++x)
                        sum += static_cast<double>(
                            values[line + static_cast<std::size_t>(x - m_window.x0)]);
                }
                result.push_back(sum / static_cast<double>(area.area()));
            }
        }
    }
    return result;
}

RegionSpread spreadOf(const PixelRect& window, std::int32_t side,
                      const std::vector<std::vector<double>>& means) {
    if (means.size() < 3)
        throw HostError(ExitCode::kInternal, "a spread is of three renders at least");
    RegionSpread spread;
    spread.side = side;
    spread.limit = limitOfStudent(kFalseAlarm, means.front().size(),
                                  static_cast<std::int32_t>(means.size()) - 1);
    for (std::size_t one = 0; one < means.size(); ++one) {
        measure(spread, means, one);
        const double z = std::abs(furthestRegion(window, spread, means[one]).z);
        spread.limit = std::max(spread.limit, kBeyondOwn * z);
    }
    spread.limit = std::min(spread.limit, kMostLimit);
    measure(spread, means, means.size());
    spread.stored = means.front();
    return spread;
}

RegionFinding furthestRegion(const PixelRect& window, const RegionSpread& spread,
                             const std::vector<double>& means, double floor) {
    const RegionGrid grid(window, spread.side);
    const std::vector<double> variances = variancesOf(spread);
    RegionFinding found;
    for (std::size_t i = 0; i < means.size(); ++i) {
        const double mean = spread.mean[i], off = means[i] - mean;
        const double beyond = std::copysign(std::max(std::abs(off) - floor, 0.0), off);
        const double z = beyond == 0 ? 0 : beyond / std::sqrt(variances[i]);
        if (i != 0 && std::abs(z) <= std::abs(found.z)) continue;
        found = {grid.rectOf(i / 3), static_cast<int>(i % 3), z, mean != 0 ? off / mean : 0};
        if (std::isnan(z)) break;  // nothing is farther off
    }
    return found;
}

std::vector<RegionFinding> changedRegions(const PixelRect& window, std::int32_t side,
                                          const std::vector<double>& wanted,
                                          const std::vector<double>& got, std::size_t most) {
    const RegionGrid grid(window, side);
    std::vector<RegionFinding> regions(wanted.size() / 3);
    for (std::size_t i = 0; i < wanted.size(); ++i) {
        const double off = got[i] - wanted[i];
        const double relative = wanted[i] != 0 ? off / std::abs(wanted[i]) : off;
        RegionFinding& region = regions[i / 3];
        if (i % 3 != 0 && !isFarther(relative, region.relative)) continue;
        region = {grid.rectOf(i / 3), static_cast<int>(i % 3), 0, relative};
    }
    std::ranges::stable_sort(regions, [](const RegionFinding& a, const RegionFinding& b) {
        return isFarther(a.relative, b.relative);
    });
    regions.resize(std::min(regions.size(), most));
    std::erase_if(regions, [](const RegionFinding& region) { return region.relative == 0; });
    return regions;
}

RegionFinding mostChangedRegion(const PixelRect& window, std::int32_t side,
                                const std::vector<double>& wanted, const std::vector<double>& got) {
    const std::vector<RegionFinding> changed = changedRegions(window, side, wanted, got, 1);
    return changed.empty() ? RegionFinding{RegionGrid(window, side).rectOf(0), 0, 0, 0}
                           : changed.front();
}

double seenChange(const RegionSpread& spread) {
    const std::vector<double> variances = variancesOf(spread);
    std::vector<double> changes;
    for (std::size_t i = 0; i < variances.size(); ++i)
        if (spread.mean[i] > 0)
            changes.push_back(spread.limit * std::sqrt(variances[i]) / spread.mean[i]);
    if (changes.empty()) return 0;
    const auto middle = changes.begin() + static_cast<std::ptrdiff_t>(changes.size() / 2);
    std::ranges::nth_element(changes, middle);
    return *middle;
}

std::string describe(const RegionFinding& finding) {
    return fmt::format(
        "region {},{} to {},{}: {} is {:.3g} % {}", finding.rect.x0, finding.rect.y0,
        finding.rect.x1, finding.rect.y1, kChannels[static_cast<std::size_t>(finding.channel)],
        100 * std::abs(finding.relative), finding.relative < 0 ? "darker" : "brighter");
}

}  // namespace pm::host
