// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/geometry/quad_blocks.h"

#include <algorithm>

namespace pm {

QuadBlocks::QuadBlocks(EdgeRates rates)
    : m_rates(rates),
      m_cells{std::max({2, rates[0], rates[2]}), std::max({2, rates[1], rates[3]})} {}

bool QuadBlocks::fit(EdgeRates rates) {
    return rates.size() == 4 && std::ranges::any_of(rates, [](int rate) { return rate > kSide; });
}

std::uint32_t QuadBlocks::blocks() const {
    const auto across = [](int cells) { return (cells - 2 + kSide - 1) / kSide; };
    return static_cast<std::uint32_t>(across(m_cells[0]) * across(m_cells[1]));
}

QuadBlocks::Block QuadBlocks::block(std::uint32_t part) const {
    const int columns = (m_cells[0] - 2 + kSide - 1) / kSide;
    const int i0 = 1 + kSide * (static_cast<int>(part) % columns),
              j0 = 1 + kSide * (static_cast<int>(part) / columns);
    return {i0, std::min(i0 + kSide, m_cells[0] - 1), j0, std::min(j0 + kSide, m_cells[1] - 1)};
}

std::uint32_t QuadBlocks::triangles(std::uint32_t part) const {
    if (part < blocks()) {
        const Block b = block(part);
        return static_cast<std::uint32_t>(2 * (b.i1 - b.i0) * (b.j1 - b.j0));
    }
    const std::uint32_t side = part - blocks();
    return static_cast<std::uint32_t>(m_rates[side] + along(side) - 2);
}

// The same bits in whichever part a point is.
PatternPoint QuadBlocks::gridPoint(int i, int j) const {
    return {{static_cast<double>(i) / m_cells[0], static_cast<double>(j) / m_cells[1]}};
}

PatternPoint QuadBlocks::innerPoint(std::uint32_t side, int b) const {
    switch (side) {
        case 0:
            return gridPoint(b, 1);
        case 1:
            return gridPoint(m_cells[0] - 1, b);
        case 2:
            return gridPoint(m_cells[0] - b, m_cells[1] - 1);
        default:
            return gridPoint(1, m_cells[1] - b);
    }
}

PatternPoint QuadBlocks::outerPoint(std::uint32_t side, int a) const {
    const int rate = m_rates[side];
    PatternPoint point;
    point.edge = a == rate ? (side + 1) % 4 : side;
    point.step = a == rate ? 0 : static_cast<std::uint32_t>(a);
    point.uv = pointOfEdge(SubdivisionScheme::kCatmullClark, 4, point.edge,
                           static_cast<double>(point.step) / m_rates[point.edge]);
    return point;
}

void QuadBlocks::make(std::uint32_t part, FacePattern& pattern) const {
    pattern.clear();
    if (part >= blocks()) return makeStrip(part - blocks(), pattern);
    const Block b = block(part);
    const auto row = static_cast<std::uint32_t>(b.i1 - b.i0 + 1);
    for (int j = b.j0; j <= b.j1; ++j)
        for (int i = b.i0; i <= b.i1; ++i) pattern.points.push_back(gridPoint(i, j));
    for (int j = b.j0; j < b.j1; ++j)
        for (int i = b.i0; i < b.i1; ++i) {
            const auto at =
                static_cast<std::uint32_t>(j - b.j0) * row + static_cast<std::uint32_t>(i - b.i0);
            pattern.facets.push_back({at, at + 1, at + row + 1});
            pattern.facets.push_back({at, at + row + 1, at + row});
        }
}

// Goes along both rows of points at once, always on where the next piece's middle comes first.
void QuadBlocks::makeStrip(std::uint32_t side, FacePattern& pattern) const {
    const int rate = m_rates[side], cells = along(side);
    for (int a = 0; a <= rate; ++a) pattern.points.push_back(outerPoint(side, a));
    for (int b = 1; b < cells; ++b) pattern.points.push_back(innerPoint(side, b));
    const auto outer = [](int a) { return static_cast<std::uint32_t>(a); };
    const auto inner = [rate](int b) { return static_cast<std::uint32_t>(rate + b); };
    int a = 0, b = 1;
    while (a < rate || b < cells - 1) {
        const bool goesOutside =
            a < rate && (b == cells - 1 || (2 * a + 1) * cells <= (2 * b + 1) * rate);
        if (goesOutside) {
            pattern.facets.push_back({outer(a), outer(a + 1), inner(b)});
            ++a;
        } else {
            pattern.facets.push_back({outer(a), inner(b + 1), inner(b)});
            ++b;
        }
    }
}

PatternDomain QuadBlocks::domain(std::uint32_t part) const {
    const double u = 1.0 / m_cells[0], v = 1.0 / m_cells[1];
    if (part < blocks()) {
        const Block b = block(part);
        return {{b.i0 * u, b.j0 * v}, {b.i1 * u, b.j1 * v}};
    }
    switch (part - blocks()) {
        case 0:
            return {{0, 0}, {1, v}};
        case 1:
            return {{1 - u, 0}, {1, 1}};
        case 2:
            return {{0, 1 - v}, {1, 1}};
        default:
            return {{0, 0}, {u, 1}};
    }
}

}  // namespace pm
