// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/geometry/reflex_points.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numeric>

namespace pm {
namespace {

constexpr std::uint32_t kLeafPoints = 8;

// a*b - c*d within 1.5 units in the last place, so its sign is right. Jeannerod, Louvet, Muller,
// Further analysis of Kahan's algorithm for the accurate computation of 2x2 determinants, 2013.
double differenceOfProducts(double a, double b, double c, double d) {
    const double cd = c * d;
    const double error = std::fma(-c, d, cd);
    return std::fma(a, b, -cd) + error;
}

bool isSame(const Point2& p, const Point2& q) {
    return p.x == q.x && p.y == q.y;
}

}  // namespace

double orientation(const Point2& a, const Point2& b, const Point2& c) {
    return differenceOfProducts(b.x - a.x, c.y - a.y, b.y - a.y, c.x - a.x);
}

struct ReflexPoints::Triangle {
    std::array<Point2, 3> corners;
    bool closed;
    Point2 low, high;

    Triangle(const Point2& a, const Point2& b, const Point2& c, bool isClosed)
        : corners{a, b, c},
          closed(isClosed),
          low{std::min({a.x, b.x, c.x}), std::min({a.y, b.y, c.y})},
          high{std::max({a.x, b.x, c.x}), std::max({a.y, b.y, c.y})} {}

    bool holds(double area) const { return closed ? area >= 0 : area > 0; }

    bool holds(const Point2& p) const {
        if (p.x < low.x || p.x > high.x || p.y < low.y || p.y > high.y) return false;
        if (std::ranges::any_of(corners, [&](const Point2& q) { return isSame(p, q); }))
            return false;
        return holds(orientation(corners[0], corners[1], p)) &&
               holds(orientation(corners[1], corners[2], p)) &&
               holds(orientation(corners[2], corners[0], p));
    }

    // Whether a point of a box may be in it: no edge has the corner of the box that is farthest to
    // its left on its right. Differences round monotonically and the sign is right, so no point of
    // the box is told otherwise.
    bool mayHold(const Point2& boxLow, const Point2& boxHigh) const {
        if (boxHigh.x < low.x || boxLow.x > high.x || boxHigh.y < low.y || boxLow.y > high.y)
            return false;
        for (std::size_t i = 0; i < 3; ++i) {
            const Point2 &p = corners[i], &q = corners[(i + 1) % 3];
            const Point2 farthest{q.y >= p.y ? boxLow.x : boxHigh.x,
                                  q.x >= p.x ? boxHigh.y : boxLow.y};
            if (!holds(orientation(p, q, farthest))) return false;
        }
        return true;
    }
};

void ReflexPoints::reset(std::span<const Point2> points) {
    m_points = points;
    const auto count = static_cast<std::uint32_t>(points.size());
    m_order.resize(count);
    std::iota(m_order.begin(), m_order.end(), 0u);
    m_leaf.resize(count);
    m_isReflex.assign(count, 0);
    const std::uint32_t leaves = std::bit_ceil((count + kLeafPoints - 1) / kLeafPoints);
    m_nodes.assign(2 * static_cast<std::size_t>(leaves) - 1, Node{});
    build(0, 0, count);
}

void ReflexPoints::build(std::uint32_t node, std::uint32_t first, std::uint32_t end) {
    Node& box = m_nodes[node];
    box.first = first;
    box.end = end;
    if (first < end) box.low = box.high = m_points[m_order[first]];
    for (std::uint32_t i = first; i < end; ++i) {
        const Point2& p = m_points[m_order[i]];
        box.low = {std::min(box.low.x, p.x), std::min(box.low.y, p.y)};
        box.high = {std::max(box.high.x, p.x), std::max(box.high.y, p.y)};
    }
    if (2 * static_cast<std::size_t>(node) + 1 >= m_nodes.size()) {
        for (std::uint32_t i = first; i < end; ++i) m_leaf[m_order[i]] = node;
        return;
    }
    const std::uint32_t middle = first + (end - first) / 2;
    const bool byX = box.high.x - box.low.x >= box.high.y - box.low.y;
    std::nth_element(m_order.begin() + first, m_order.begin() + middle, m_order.begin() + end,
                     [&](std::uint32_t a, std::uint32_t b) {
                         return byX ? m_points[a].x < m_points[b].x : m_points[a].y < m_points[b].y;
                     });
    build(2 * node + 1, first, middle);
    build(2 * node + 2, middle, end);
}

void ReflexPoints::add(std::uint32_t point, std::uint32_t difference) {
    for (std::uint32_t node = m_leaf[point];; node = (node - 1) / 2) {
        m_nodes[node].count += difference;
        if (node == 0) return;
    }
}

void ReflexPoints::insert(std::uint32_t point) {
    m_isReflex[point] = 1;
    add(point, 1);
}

void ReflexPoints::erase(std::uint32_t point) {
    m_isReflex[point] = 0;
    add(point, 0u - 1u);
}

std::uint32_t ReflexPoints::findIn(std::uint32_t a, std::uint32_t b, std::uint32_t c,
                                   bool closed) const {
    const Triangle triangle(m_points[a], m_points[b], m_points[c], closed);
    std::array<std::uint32_t, 64> open{};  // more than twice the depth of a tree of 32-bit numbers
    for (std::size_t left = 1; left > 0;) {
        const std::uint32_t i = open[--left];
        const Node& node = m_nodes[i];
        if (node.count == 0 || !triangle.mayHold(node.low, node.high)) continue;
        if (2 * static_cast<std::size_t>(i) + 1 >= m_nodes.size()) {
            for (std::uint32_t k = node.first; k < node.end; ++k)
                if (has(m_order[k]) && triangle.holds(m_points[m_order[k]])) return m_order[k];
            continue;
        }
        // Many ears that hold the same points are each told of another: else all would be looked
        // at again whenever one of these points goes.
        const std::uint32_t which = std::popcount(b * 0x9e3779b9u & (i + 1) * 0x85ebca6bu) & 1u;
        open[left++] = 2 * i + 1 + which;
        open[left++] = 2 * i + 2 - which;
    }
    return kNone;
}

}  // namespace pm
