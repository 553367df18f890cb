// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/geometry/polygon_clipper.h"

#include <algorithm>
#include <cmath>

namespace pm {
namespace {

constexpr std::uint32_t kNone = ReflexPoints::kNone;

}  // namespace

Vec3d newellNormal(std::span<const Vec3d> points) {
    // Relative to the first point, so that a polygon far from the origin keeps its digits.
    Vec3d sum;
    for (std::size_t i = 1; i + 1 < points.size(); ++i) {
        sum += cross(points[i] - points[0], points[i + 1] - points[0]);
    }
    return sum;
}

bool PolygonClipper::clip(std::span<const Vec3d> points,
                          std::vector<TriangleMesh::Corners>& triangles) {
    if (points.size() == 3) {
        triangles.push_back({0, 1, 2});
        return true;
    }
    if (points.size() == 4) return clipQuad(points, triangles);

    const Vec3d normal = newellNormal(points);
    const double normalLength = length(normal);
    if (!(normalLength > 0)) {
        for (std::uint32_t i = 1; i + 1 < points.size(); ++i) triangles.push_back({0, i, i + 1});
        return false;
    }
    project(points, normal / normalLength);
    linkRing();
    return clipRing(triangles);
}

bool PolygonClipper::clipQuad(std::span<const Vec3d> points,
                              std::vector<TriangleMesh::Corners>& triangles) const {
    const Vec3d normal = newellNormal(points);
    const auto signedArea = [&](int a, int b, int c) {
        const Vec3d& origin = points[static_cast<std::size_t>(a)];
        return dot(cross(points[static_cast<std::size_t>(b)] - origin,
                         points[static_cast<std::size_t>(c)] - origin),
                   normal);
    };
    const double worst02 = std::min(signedArea(0, 1, 2), signedArea(0, 2, 3));
    const double worst13 = std::min(signedArea(0, 1, 3), signedArea(1, 2, 3));
    // Twice areas times the length of the normal: both are in units of the normal squared.
    const double flat = 1e-12 * lengthSquared(normal);
    const bool bothFit = worst02 > flat && worst13 > flat;
    // Both diagonals of a convex quad will do; the shorter follows a bent one better. Those of a
    // rectangle are alike, whatever rounding makes of them.
    constexpr double kAlike = 1 + 1e-5;
    const bool use02 = bothFit ? lengthSquared(points[2] - points[0]) <=
                                     kAlike * lengthSquared(points[3] - points[1])
                               : worst02 >= worst13;
    if (use02) {
        triangles.push_back({0, 1, 2});
        triangles.push_back({0, 2, 3});
    } else {
        triangles.push_back({0, 1, 3});
        triangles.push_back({1, 2, 3});
    }
    return (use02 ? worst02 : worst13) >= -flat && lengthSquared(normal) > 0;
}

void PolygonClipper::project(std::span<const Vec3d> points, const Vec3d& normal) {
    // Two axes of the plane. With a normal along a coordinate axis they are coordinate axes too,
    // and the projection is exact.
    const bool alongX = std::abs(normal.x) > 0.9;
    const Vec3d helper = alongX ? Vec3d(0, 1, 0) : Vec3d(1, 0, 0);
    const Vec3d u = normalize(helper - normal * dot(helper, normal));
    const Vec3d v = cross(normal, u);
    m_points.clear();
    double extent = 0;
    for (const Vec3d& point : points) {
        const Vec3d p = point - points[0];
        m_points.push_back({dot(p, u), dot(p, v)});
        extent = std::max({extent, std::abs(m_points.back().x), std::abs(m_points.back().y)});
    }
    m_flatArea = 1e-14 * extent * extent;
}

void PolygonClipper::linkRing() {
    const auto count = static_cast<std::uint32_t>(m_points.size());
    m_next.resize(count);
    m_previous.resize(count);
    for (std::uint32_t i = 0; i < count; ++i) {
        m_next[i] = i + 1 == count ? 0 : i + 1;
        m_previous[i] = i == 0 ? count - 1 : i - 1;
    }
    m_reflex.reset(m_points);
    for (RingMarks& maybe : m_maybe) maybe.reset(count);
    m_waits.clear();
    m_firstWait.assign(count, kNone);
    for (std::uint32_t i = 0; i < count; ++i) classify(i);
}

// Twice the area of the triangle that a corner makes with its neighbours.
double PolygonClipper::areaAt(std::uint32_t corner) const {
    return orientation(m_points[m_previous[corner]], m_points[corner], m_points[m_next[corner]]);
}

// Enters a corner among the reflex ones or takes it out.
void PolygonClipper::classify(std::uint32_t corner) {
    const bool reflex = areaAt(corner) <= m_flatArea;
    if (reflex == m_reflex.has(corner)) return;
    if (reflex) {
        m_reflex.insert(corner);
    } else {
        m_reflex.erase(corner);
        endWaitsFor(corner);
    }
}

void PolygonClipper::endWaitsFor(std::uint32_t corner) {
    for (std::uint32_t i = m_firstWait[corner]; i != kNone; i = m_waits[i].next)
        if (m_next[m_waits[i].corner] != kNone)
            m_maybe[static_cast<std::size_t>(m_waits[i].kind)].set(m_waits[i].corner);
    m_firstWait[corner] = kNone;
}

// Only a corner that is not convex can lie in an ear first. Notes what stands in the way.
bool PolygonClipper::isFree(std::uint32_t corner, Ear kind) {
    const std::uint32_t inWay =
        m_reflex.findIn(m_previous[corner], corner, m_next[corner], kind == Ear::kClear);
    if (inWay == kNone) return true;
    m_waits.push_back({corner, kind, m_firstWait[inWay]});
    m_firstWait[inWay] = static_cast<std::uint32_t>(m_waits.size() - 1);
    return false;
}

bool PolygonClipper::isEar(std::uint32_t corner, Ear kind) {
    const double area = areaAt(corner);
    switch (kind) {
        case Ear::kClear:
            return area > m_flatArea && isFree(corner, kind);
        case Ear::kFlat:
            return std::abs(area) <= m_flatArea;
        case Ear::kTouched:
            return area > 0 && isFree(corner, kind);
    }
    return false;
}

// The first one from a corner on, all round; kNone where there is none.
std::uint32_t PolygonClipper::findEar(std::uint32_t from, Ear kind) {
    RingMarks& maybe = m_maybe[static_cast<std::size_t>(kind)];
    while (true) {
        const std::uint32_t corner = maybe.firstFrom(from);
        if (corner == kNone || isEar(corner, kind)) return corner;
        maybe.clear(corner);
    }
}

// Takes a corner out of the ring and returns the next one.
std::uint32_t PolygonClipper::remove(std::uint32_t corner) {
    const std::uint32_t before = m_previous[corner], after = m_next[corner];
    m_next[before] = after;
    m_previous[after] = before;
    m_next[corner] = kNone;
    for (RingMarks& maybe : m_maybe) {
        maybe.clear(corner);
        maybe.set(before);
        maybe.set(after);
    }
    if (m_reflex.has(corner)) {
        m_reflex.erase(corner);
        endWaitsFor(corner);
    }
    classify(before);
    classify(after);
    return after;
}

bool PolygonClipper::clipRing(std::vector<TriangleMesh::Corners>& triangles) {
    std::size_t left = m_points.size();
    std::uint32_t corner = 0;
    while (left > 3) {
        std::uint32_t ear = kNone;
        for (const Ear kind : {Ear::kClear, Ear::kFlat, Ear::kTouched}) {
            ear = findEar(corner, kind);
            if (ear != kNone) break;
        }
        if (ear == kNone) break;
        corner = ear;
        triangles.push_back({m_previous[corner], corner, m_next[corner]});
        // Going on two corners further keeps the triangles from all sharing one point.
        corner = m_next[remove(corner)];
        --left;
    }
    const bool clean = left == 3;
    for (std::uint32_t i = m_next[corner]; left > 2; --left, i = m_next[i]) {
        triangles.push_back({corner, i, m_next[i]});
    }
    return clean;
}

}  // namespace pm
