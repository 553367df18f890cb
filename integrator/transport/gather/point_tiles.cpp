// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/transport/gather/point_tiles.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace pm {

namespace {

// How far a sample may lie from its pixel (a group's side, a wide filter), and rounding; pixels.
constexpr double kBeyondPixel = 8.0;

std::int32_t cellsAcross(std::int32_t pixels, float spacing) {
    return static_cast<std::int32_t>(std::ceil(static_cast<float>(pixels) / spacing)) +
           2 * PointTiles::kMargin;
}

std::int32_t toInt(double x) {
    return static_cast<std::int32_t>(std::clamp(x, -0x1p30, 0x1p30));
}

}  // namespace

PointTiles::PointTiles(std::int32_t width, std::int32_t height, float spacing, float radius)
    : m_columns(cellsAcross(width, spacing)),
      m_rows(cellsAcross(height, spacing)),
      m_tilePixels(static_cast<double>(kSide) * static_cast<double>(spacing)),
      m_marginPixels(static_cast<double>(kMargin) * static_cast<double>(spacing)),
      m_reachPixels(static_cast<double>(radius) + kBeyondPixel) {}

Rect PointTiles::reach(std::size_t tile) const {
    const auto width = static_cast<std::size_t>(across());
    const auto first = [&](std::size_t at) {
        return toInt(
            std::floor(static_cast<double>(at) * m_tilePixels - m_marginPixels - m_reachPixels));
    };
    const auto last = [&](std::size_t at) {
        return toInt(
            std::ceil(static_cast<double>(at + 1) * m_tilePixels - m_marginPixels + m_reachPixels));
    };
    const std::size_t column = tile % width, row = tile / width;
    return {first(column), first(row), last(column), last(row)};
}

Rect PointTiles::asked(const Rect& region) const {
    if (region.empty()) return {};
    const auto at = [&](double pixels, std::int32_t most) {
        return std::clamp(toInt(std::floor((pixels + m_marginPixels) / m_tilePixels)), 0, most);
    };
    return {at(region.x0 - m_reachPixels - 1.0, across()),
            at(region.y0 - m_reachPixels - 1.0, down()),
            at(region.x1 + m_reachPixels + m_tilePixels, across()),
            at(region.y1 + m_reachPixels + m_tilePixels, down())};
}

std::size_t PointTiles::mostAtOnce(std::span<const Rect> regions, const Rect& all,
                                   std::size_t atOnce) const {
    constexpr std::size_t kMostRegions = std::size_t{1} << 20;
    if (regions.size() > kMostRegions) return static_cast<std::size_t>(asked(all).area());
    std::vector<std::int64_t> left(count(), -1);  // pixels to be done; -1: not there yet
    std::size_t held = 0, most = 0, largest = 0;
    for (const Rect& region : regions) {
        const Rect tiles = asked(region);
        const auto visit = [&](const auto& what) {
            for (std::int32_t y = tiles.y0; y < tiles.y1; ++y)
                for (std::int32_t x = tiles.x0; x < tiles.x1; ++x)
                    what(static_cast<std::size_t>(y) * static_cast<std::size_t>(across()) +
                         static_cast<std::size_t>(x));
        };
        visit([&](std::size_t tile) {
            if (left[tile] >= 0) return;
            left[tile] = intersect(reach(tile), all).area();
            held += left[tile] > 0;
        });
        most = std::max(most, held);
        largest = std::max(largest, static_cast<std::size_t>(tiles.area()));
        visit([&](std::size_t tile) {
            const std::int64_t done = intersect(reach(tile), region).area();
            left[tile] -= done;
            if (left[tile] == 0 && done > 0) --held;
        });
    }
    const auto everAsked = static_cast<std::size_t>(asked(all).area());
    return std::min(everAsked, most + (atOnce > 0 ? atOnce - 1 : 0) * largest);
}

}  // namespace pm
