// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/geometry/polygon_clipper.h"

#include <algorithm>
#include <cmath>

namespace pm {
namespace {

constexpr std::uint32_t kNoSlot = 0xffffffffu;

// a*b - c*d within 1.5 units in the last place, so its sign is right. Jeannerod, Louvet, Muller,
// Further analysis of Kahan's algorithm for the accurate computation of 2x2 determinants, 2013.
double differenceOfProducts(double a, double b, double c, double d) {
    const double cd = c * d;
    const double error = std::fma(-c, d, cd);
    return std::fma(a, b, -cd) + error;
}

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
    // Both diagonals of a convex quad will do; the shorter follows a bent one better.
    const bool use02 =
        bothFit ? lengthSquared(points[2] - points[0]) <= lengthSquared(points[3] - points[1])
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
    m_reflex.clear();
    m_reflexSlot.assign(count, kNoSlot);
    for (std::uint32_t i = 0; i < count; ++i) classify(i);
}

double PolygonClipper::orientation(std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
    const Point2 &p = m_points[a], &q = m_points[b], &r = m_points[c];
    return differenceOfProducts(q.x - p.x, r.y - p.y, q.y - p.y, r.x - p.x);
}

// Enters a corner into the list of reflex ones or takes it out.
void PolygonClipper::classify(std::uint32_t corner) {
    const bool reflex = orientation(m_previous[corner], corner, m_next[corner]) <= m_flatArea;
    std::uint32_t& slot = m_reflexSlot[corner];
    if (reflex && slot == kNoSlot) {
        slot = static_cast<std::uint32_t>(m_reflex.size());
        m_reflex.push_back(corner);
    } else if (!reflex && slot != kNoSlot) {
        m_reflexSlot[m_reflex.back()] = slot;
        m_reflex[slot] = m_reflex.back();
        m_reflex.pop_back();
        slot = kNoSlot;
    }
}

// Only a corner that is not convex can lie in an ear first.
bool PolygonClipper::containsReflexPoint(std::uint32_t corner, bool closed) const {
    const std::uint32_t a = m_previous[corner], c = m_next[corner];
    const Point2 &pa = m_points[a], &pb = m_points[corner], &pc = m_points[c];
    const double left = std::min({pa.x, pb.x, pc.x}), right = std::max({pa.x, pb.x, pc.x});
    const double low = std::min({pa.y, pb.y, pc.y}), high = std::max({pa.y, pb.y, pc.y});
    const auto same = [](const Point2& p, const Point2& q) { return p.x == q.x && p.y == q.y; };
    const auto inside = [closed](double area) { return closed ? area >= 0 : area > 0; };
    return std::any_of(m_reflex.begin(), m_reflex.end(), [&](std::uint32_t i) {
        const Point2& p = m_points[i];
        if (p.x < left || p.x > right || p.y < low || p.y > high) return false;
        // A slit to a hole visits its points twice; they don't stand in their own way.
        if (same(p, pa) || same(p, pb) || same(p, pc)) return false;
        return inside(orientation(a, corner, i)) && inside(orientation(corner, c, i)) &&
               inside(orientation(c, a, i));
    });
}

bool PolygonClipper::isEar(std::uint32_t corner, Ear kind) const {
    const double area = orientation(m_previous[corner], corner, m_next[corner]);
    switch (kind) {
        case Ear::kClear:
            return area > m_flatArea && !containsReflexPoint(corner, true);
        case Ear::kFlat:
            return std::abs(area) <= m_flatArea;
        case Ear::kTouched:
            return area > 0 && !containsReflexPoint(corner, false);
    }
    return false;
}

// Takes a corner out of the ring and returns the next one.
std::uint32_t PolygonClipper::remove(std::uint32_t corner) {
    const std::uint32_t before = m_previous[corner], after = m_next[corner];
    m_next[before] = after;
    m_previous[after] = before;
    if (m_reflexSlot[corner] != kNoSlot) {
        const std::uint32_t slot = m_reflexSlot[corner];
        m_reflexSlot[m_reflex.back()] = slot;
        m_reflex[slot] = m_reflex.back();
        m_reflex.pop_back();
        m_reflexSlot[corner] = kNoSlot;
    }
    classify(before);
    classify(after);
    return after;
}

bool PolygonClipper::clipRing(std::vector<TriangleMesh::Corners>& triangles) {
    std::size_t left = m_points.size();
    std::uint32_t corner = 0;
    while (left > 3) {
        bool found = false;
        for (const Ear kind : {Ear::kClear, Ear::kFlat, Ear::kTouched}) {
            for (std::size_t i = 0; i < left && !found; ++i) {
                found = isEar(corner, kind);
                if (!found) corner = m_next[corner];
            }
            if (found) break;
        }
        if (!found) break;
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
