// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "scheduler/film/correlated_choice.h"

#include <limits>
#include <utility>

namespace pm {
namespace {

// No grid has that many cells.
constexpr std::uint32_t kNoCell = std::numeric_limits<std::uint32_t>::max();

}  // namespace

CorrelatedChoice::Edge& CorrelatedChoice::Edge::operator+=(const Edge& other) {
    count += other.count;
    sum += other.sum;
    sumOfSquares += other.sumOfSquares;
    return *this;
}

CorrelatedChoice::CorrelatedChoice(const BucketGrid& grid, std::span<const std::uint32_t> order,
                                   int workers, Missing missing)
    : m_grid(grid),
      m_order(order),
      m_missing(std::move(missing)),
      m_cells(grid.cellCount()),
      m_last(static_cast<std::size_t>(workers), kNoCell) {
    for (std::size_t place = 0; place < order.size(); ++place) {
        m_cells[order[place]].place = place;
        m_cells[order[place]].begun = false;
    }
}

std::uint32_t CorrelatedChoice::neighbour(std::uint32_t cell, std::size_t side) const {
    const auto columns = static_cast<std::uint32_t>(m_grid.columns());
    const std::uint32_t column = cell % columns;
    switch (side) {
        case kLeft:
            return column > 0 ? cell - 1 : kNoCell;
        case kRight:
            return column + 1 < columns ? cell + 1 : kNoCell;
        case kTop:
            return cell >= columns ? cell - columns : kNoCell;
        default:
            return m_grid.cellCount() - cell > columns ? cell + columns : kNoCell;
    }
}

// Infinite where no neighbour is finished.
float CorrelatedChoice::disagreement(std::uint32_t cell) const {
    static constexpr std::array<Side, 4> kFacing{kRight, kLeft, kBottom, kTop};
    Edge all;
    for (std::size_t side = 0; side < kFacing.size(); ++side) {
        const std::uint32_t beside = neighbour(cell, side);
        if (beside != kNoCell) all += m_cells[beside].edges[kFacing[side]];
    }
    if (all.count == 0.0f) return std::numeric_limits<float>::infinity();
    const float meanSquared = all.sum * all.sum / (all.count * all.count);
    // Black edges agree with each other.
    if (meanSquared == 0.0f) return 0.0f;
    return (all.sumOfSquares / all.count - meanSquared) / meanSquared;
}

// What is missing is a share, how edges disagree has no bound: the first, where it is known.
float CorrelatedChoice::cost(std::uint32_t cell) const {
    const float missing = m_missing ? m_missing(cell) : std::numeric_limits<float>::quiet_NaN();
    return missing >= 0.0f ? missing : disagreement(cell);
}

// Its place in the order, kNowhere where there is none to choose. Of equal ones the first in the
// order; a NaN in the picture is never best.
std::size_t CorrelatedChoice::bestNeighbour(std::uint32_t cell) const {
    std::size_t best = kNowhere;
    float least = std::numeric_limits<float>::infinity();
    for (std::size_t side = 0; side < 4; ++side) {
        const std::uint32_t beside = neighbour(cell, side);
        if (beside == kNoCell || m_cells[beside].begun) continue;
        const float value = cost(beside);
        const std::size_t place = m_cells[beside].place;
        if (value < least || (value == least && best != kNowhere && place < best)) {
            least = value;
            best = place;
        }
    }
    return best;
}

std::size_t CorrelatedChoice::next(int worker) {
    const std::lock_guard lock(m_mutex);
    std::uint32_t& last = m_last[static_cast<std::size_t>(worker)];
    std::size_t place = last == kNoCell ? kNowhere : bestNeighbour(last);
    if (place == kNowhere) {
        while (m_firstLeft < m_order.size() && m_cells[m_order[m_firstLeft]].begun) ++m_firstLeft;
        place = m_firstLeft;
    }
    if (place == m_order.size()) return place;
    last = m_order[place];
    m_cells[last].begun = true;
    return place;
}

void CorrelatedChoice::finished(std::uint32_t cell, std::span<const float> pixels,
                                std::size_t floatsPerPixel, std::size_t first) {
    const Rect rect = m_grid.cellRect(cell);
    const auto width = static_cast<std::size_t>(rect.width());
    const auto height = static_cast<std::size_t>(rect.height());
    const auto edgeOf = [&](std::size_t from, std::size_t step, std::size_t count) {
        Edge edge;
        for (std::size_t i = 0; i < count; ++i, from += step) {
            const float* const rgb = pixels.data() + from * floatsPerPixel + first;
            const float value = (rgb[0] + rgb[1] + rgb[2]) * (1.0f / 3.0f);
            edge += {1.0f, value, value * value};
        }
        return edge;
    };
    const std::array<Edge, 4> edges{edgeOf(0, width, height), edgeOf(width - 1, width, height),
                                    edgeOf(0, 1, width), edgeOf((height - 1) * width, 1, width)};
    const std::lock_guard lock(m_mutex);
    m_cells[cell].edges = edges;
}

}  // namespace pm
