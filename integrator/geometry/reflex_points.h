// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace pm {

struct Point2 {
    double x, y;
};

// Twice the area of a triangle, positive where it goes round counter-clockwise, with the right sign
// for the differences of the coordinates as they are rounded.
double orientation(const Point2& a, const Point2& b, const Point2& c);

// The corners of a polygon's ring that are not convex, to be asked for one in a triangle. A tree of
// boxes over all corners (k-d, by medians) that counts those in it: of a polygon like a comb or a
// spiral nearly all are reflex, and a look at each for each ear would take the square of the
// corners. One thread.
class ReflexPoints {
  public:
    static constexpr std::uint32_t kNone = 0xffffffffu;

    // The points outlive this; none is reflex yet.
    void reset(std::span<const Point2> points);
    bool has(std::uint32_t point) const { return m_isReflex[point] != 0; }
    void insert(std::uint32_t point);  // that is not there
    void erase(std::uint32_t point);   // that is there

    // One in the triangle (a, b, c), which goes round counter-clockwise, or on its rim where
    // closed; kNone where there is none. Those at its corners don't count: a slit to a hole visits
    // its points twice, and they don't stand in their own way. Of several it depends on b which
    // one.
    std::uint32_t findIn(std::uint32_t a, std::uint32_t b, std::uint32_t c, bool closed) const;

  private:
    struct Node {
        Point2 low, high;
        std::uint32_t count = 0;           // reflex ones in it
        std::uint32_t first = 0, end = 0;  // in m_order
    };
    struct Triangle;

    void build(std::uint32_t node, std::uint32_t first, std::uint32_t end);
    void add(std::uint32_t point, std::uint32_t difference);

    std::span<const Point2> m_points;
    std::vector<Node> m_nodes;              // children of i: 2 i + 1 and 2 i + 2; leaves have none
    std::vector<std::uint32_t> m_order;     // points, by leaves
    std::vector<std::uint32_t> m_leaf;      // of each point
    std::vector<unsigned char> m_isReflex;  // of each point
};

}  // namespace pm
