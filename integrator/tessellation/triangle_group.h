// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "integrator/caches/page_allocator.h"
#include "integrator/tessellation/sheared_ray.h"
#include "integrator/values/vec.h"

namespace pm {

// Some hundreds of neighbouring triangles in the scene's own coordinates, ready for rays. Constant.
// Threads: any.
class TriangleGroup {
  public:
    using Corners = std::array<std::uint32_t, 3>;
    // A point of a triangle; a normal of 0 where there is none.
    struct Point {
        Vec3f position, normal;
        Vec2f texcoord;
        Vec3f tangent;  // where u grows, no unit; 0 where there is none
    };

    // Numbers the triangles anew, near ones near to each other. At least one triangle.
    TriangleGroup(const std::vector<Point>& points, const std::vector<Corners>& triangles);

    std::uint32_t triangleCount() const { return static_cast<std::uint32_t>(m_triangles.size()); }
    const Point& point(std::uint32_t triangle, std::size_t corner) const {
        return m_points[m_triangles[triangle][corner]];
    }
    const PagedVector<Point>& points() const { return m_points; }
    // Its points.
    const Corners& cornersOf(std::uint32_t triangle) const { return m_triangles[triangle]; }
    std::uint64_t memoryBytes() const;
    // What walk() asks first of a ray: whether it meets the box of all.
    const Vec3f& lo() const { return m_nodes[0].lo; }
    const Vec3f& hi() const { return m_nodes[0].hi; }

    // Calls stops(triangle, t) for all that the line meets in [tNear, tFar], in no order, until one
    // stops it: then true. It may lessen tFar on the way.
    template <typename Stops>
    bool walk(const ShearedRay& ray, double tNear, double& tFar, Stops&& stops) const;

    // The nearest of them, of equally near ones the first by number.
    struct Hit {
        std::uint32_t triangle = 0;
        double t = std::numeric_limits<double>::infinity();
    };
    bool nearest(const ShearedRay& ray, double tNear, double tFar, Hit& hit) const {
        const double infinity = std::numeric_limits<double>::infinity();
        hit.t = infinity;
        walk(ray, tNear, tFar, [&](std::uint32_t triangle, double t) {
            if (t > hit.t || (t == hit.t && triangle > hit.triangle)) return false;
            hit = {triangle, t};
            tFar = t;
            return false;
        });
        return hit.t < infinity;
    }

  private:
    static constexpr std::uint32_t kMostInLeaf = 4;
    // The first child follows its node.
    struct Node {
        Vec3f lo, hi;
        std::uint32_t firstOrSecondChild;  // triangle of a leaf
        std::uint32_t count;               // of a leaf's triangles; 0: an inner node
    };

    void build(std::uint32_t first, std::uint32_t last);
    Node nodeOf(std::uint32_t first, std::uint32_t last) const;
    std::array<Vec3f, 3> corners(std::uint32_t triangle) const {
        const Corners& at = m_triangles[triangle];
        return {m_points[at[0]].position, m_points[at[1]].position, m_points[at[2]].position};
    }

    PagedVector<Point> m_points;
    PagedVector<Corners> m_triangles;
    PagedVector<Node> m_nodes;
};

template <typename Stops>
bool TriangleGroup::walk(const ShearedRay& ray, double tNear, double& tFar, Stops&& stops) const {
    // Halves of halves: no group is so large that this would not do.
    std::array<std::uint32_t, 64> open;
    std::size_t count = 0;
    double in;
    if (ray.meetsBox(m_nodes[0].lo, m_nodes[0].hi, tNear, tFar, in)) open[count++] = 0;
    while (count > 0) {
        const std::uint32_t index = open[--count];
        const Node& node = m_nodes[index];
        if (node.count > 0) {
            for (std::uint32_t i = 0; i < node.count; ++i) {
                const std::uint32_t triangle = node.firstOrSecondChild + i;
                double t;
                if (!ray.meets(corners(triangle), t) || !(t >= tNear && t <= tFar)) continue;
                if (stops(triangle, t)) return true;
            }
            continue;
        }
        const std::uint32_t first = index + 1, second = node.firstOrSecondChild;
        double in1, in2;
        const bool meets1 = ray.meetsBox(m_nodes[first].lo, m_nodes[first].hi, tNear, tFar, in1),
                   meets2 = ray.meetsBox(m_nodes[second].lo, m_nodes[second].hi, tNear, tFar, in2);
        if (meets1 && meets2) {
            open[count++] = in1 <= in2 ? second : first;
            open[count++] = in1 <= in2 ? first : second;
        } else if (meets1 || meets2) {
            open[count++] = meets1 ? first : second;
        }
    }
    return false;
}

}  // namespace pm
