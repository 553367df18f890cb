// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "host_shim/check/region_spread.h"

#include "host_shim/pictures/host_error.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace pm::host {
namespace {

constexpr std::array<const char*, 3> kChannels{"R", "G", "B"};

// Of each region the mean variance of it and those that touch it.
std::vector<double> smoothed(const RegionGrid& grid, const std::vector<double>& variance) {
    std::vector<double> result(variance.size());
    for (std::int32_t row = 0; row < grid.rows(); ++row) {
        for (std::int32_t column = 0; column < grid.columns(); ++column) {
            for (std::size_t c = 0; c < 3; ++c) {
                double sum = 0;
                int count = 0;
                for (std::int32_t y = std::max(0, row - 1); y <= std::min(grid.rows() - 1, row + 1);
                     ++y) {
                    for (std::int32_t x = std::max(0, column - 1);
                         x <= std::min(grid.columns() - 1, column + 1); ++x) {
                        sum += variance[static_cast<std::size_t>(y * grid.columns() + x) * 3 + c];
                        ++count;
                    }
                }
                result[static_cast<std::size_t>(row * grid.columns() + column) * 3 + c] =
                    sum / count;
            }
        }
    }
    return result;
}

}  // namespace

RegionGrid::RegionGrid(const PixelRect& window, std::int32_t side)
    : m_window(window), m_side(side == 0 ? std::max(window.width(), window.height()) : side) {
    m_columns = (window.width() + m_side - 1) / m_side;
    m_rows = (window.height() + m_side - 1) / m_side;
}

PixelRect RegionGrid::rect(std::int32_t column, std::int32_t row) const {
    const std::int32_t x0 = m_window.x0 + column * m_side, y0 = m_window.y0 + row * m_side;
    return {x0, y0, std::min(x0 + m_side, m_window.x1), std::min(y0 + m_side, m_window.y1)};
}

std::vector<double> RegionGrid::means(const Picture& picture) const {
    std::vector<double> result;
    std::array<const Channel*, 3> channels{};
    for (std::size_t c = 0; c < 3; ++c) channels[c] = picture.find(kChannels[c]);
    const auto width = static_cast<std::size_t>(m_window.width());
    for (std::int32_t row = 0; row < m_rows; ++row) {
        for (std::int32_t column = 0; column < m_columns; ++column) {
            const PixelRect area = rect(column, row);
            for (const Channel* channel : channels) {
                double sum = 0;
                for (std::int32_t y = area.y0; y < area.y1; ++y) {
                    const auto line = static_cast<std::size_t>(y - m_window.y0) * width;
                    for (std::int32_t x = area.x0; x < area.x1; ++x)
                        sum += static_cast<double>(
                            channel->values[line + static_cast<std::size_t>(x - m_window.x0)]);
                }
                result.push_back(sum / static_cast<double>(area.area()));
            }
        }
    }
    return result;
}

RegionSpread spreadOf(const RegionGrid& grid, const std::vector<std::vector<double>>& means) {
    if (means.size() < 2)
        throw HostError(ExitCode::kInternal, "a spread is of two renders at least");
    RegionSpread spread;
    spread.side = grid.side();
    spread.renders = static_cast<std::int32_t>(means.size());
    spread.mean.resize(means.front().size());
    spread.variance.resize(means.front().size());
    for (std::size_t i = 0; i < spread.mean.size(); ++i) {
        double sum = 0, squares = 0;
        for (const std::vector<double>& render : means) sum += render[i];
        const double mean = sum / static_cast<double>(means.size());
        for (const std::vector<double>& render : means)
            squares += (render[i] - mean) * (render[i] - mean);
        spread.mean[i] = mean;
        spread.variance[i] = squares / static_cast<double>(means.size() - 1);
    }
    return spread;
}

std::optional<RegionFinding> furthestRegion(const RegionGrid& grid, const RegionSpread& spread,
                                            const std::vector<double>& means, double threshold) {
    // Floats that were summed in another order may differ by that of the value.
    constexpr double kRounding = 1e-6;
    const std::vector<double> around = smoothed(grid, spread.variance);
    const double ofMean = 1.0 + 1.0 / spread.renders;
    std::optional<RegionFinding> found;
    for (std::size_t i = 0; i < means.size(); ++i) {
        const double mean = spread.mean[i];
        const double variance =
            std::max(spread.variance[i], around[i]) * ofMean + kRounding * kRounding * mean * mean;
        const double off = means[i] - mean;
        const double z = off == 0 ? 0 : off / std::sqrt(variance);
        if (std::abs(z) <= (found ? std::abs(found->z) : threshold)) continue;
        const auto region = static_cast<std::int32_t>(i / 3);
        found = RegionFinding{grid.rect(region % grid.columns(), region / grid.columns()),
                              static_cast<int>(i % 3), z, mean != 0 ? off / mean : 0};
    }
    return found;
}

}  // namespace pm::host
