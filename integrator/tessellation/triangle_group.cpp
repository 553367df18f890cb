// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/tessellation/triangle_group.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace pm {

namespace {

// A corner's rounding across a ray moves an edge by 2^-24 of its length at most; boxes are larger
// by more than that, so that a ray that meets a triangle meets its box.
constexpr float kMargin = 0x1p-21f;

}  // namespace

TriangleGroup::TriangleGroup(const std::vector<Point>& points,
                             const std::vector<Corners>& triangles)
    : m_points(points.begin(), points.end()), m_triangles(triangles.begin(), triangles.end()) {
    m_nodes.reserve(m_triangles.size());
    build(0, triangleCount());
    m_nodes.shrink_to_fit();
}

std::uint64_t TriangleGroup::memoryBytes() const {
    return sizeof(*this) + PageAllocator<Point>::bytesOf(m_points.capacity()) +
           PageAllocator<Corners>::bytesOf(m_triangles.capacity()) +
           PageAllocator<Node>::bytesOf(m_nodes.capacity());
}

TriangleGroup::Node TriangleGroup::nodeOf(std::uint32_t first, std::uint32_t last) const {
    Node node{Vec3f(std::numeric_limits<float>::infinity()),
              Vec3f(-std::numeric_limits<float>::infinity()), first, last - first};
    for (std::uint32_t i = first; i < last; ++i)
        for (const Vec3f& corner : corners(i))
            for (int axis = 0; axis < 3; ++axis) {
                node.lo[axis] = std::min(node.lo[axis], corner[axis]);
                node.hi[axis] = std::max(node.hi[axis], corner[axis]);
            }
    const float margin = kMargin * maxAbsComponent(node.hi - node.lo);
    for (int axis = 0; axis < 3; ++axis) {
        node.lo[axis] = std::nextafter(node.lo[axis] - margin, -INFINITY);
        node.hi[axis] = std::nextafter(node.hi[axis] + margin, INFINITY);
    }
    return node;
}

// Halves by the middles of the triangles along the box's longest axis.
void TriangleGroup::build(std::uint32_t first, std::uint32_t last) {
    const std::size_t index = m_nodes.size();
    m_nodes.push_back(nodeOf(first, last));
    if (last - first <= kMostInLeaf) return;
    const Vec3f size = m_nodes[index].hi - m_nodes[index].lo;
    const int axis = size.x >= size.y ? (size.x >= size.z ? 0 : 2) : (size.y >= size.z ? 1 : 2);
    const auto key = [&](const Corners& t) {
        return std::pair(m_points[t[0]].position[axis] + m_points[t[1]].position[axis] +
                             m_points[t[2]].position[axis],
                         t);
    };
    const std::uint32_t middle = first + (last - first) / 2;
    const auto begin = m_triangles.begin();
    std::nth_element(begin + first, begin + middle, begin + last,
                     [&](const Corners& a, const Corners& b) { return key(a) < key(b); });
    m_nodes[index].count = 0;
    build(first, middle);
    m_nodes[index].firstOrSecondChild = static_cast<std::uint32_t>(m_nodes.size());
    build(middle, last);
}

}  // namespace pm
