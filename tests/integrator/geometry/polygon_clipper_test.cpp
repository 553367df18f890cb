// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// The clipper finds its ears by a tree and by marks. Here is what it has to find: the same ears as
// by a look at every corner.
#include "integrator/geometry/polygon_clipper.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "integrator/geometry/reflex_points.h"
#include "integrator/geometry/ring_marks.h"

namespace pm {
namespace {

using Triangles = std::vector<TriangleMesh::Corners>;

// Ear clipping by a look at every corner, of polygons in the plane z = 0 with a normal along z.
class PlainClipper {
  public:
    explicit PlainClipper(const std::vector<Vec3d>& points) {
        double extent = 0;
        for (const Vec3d& p : points) {
            // As the clipper's own axes for this normal.
            m_points.push_back({p.x - points[0].x, p.y - points[0].y});
            extent = std::max({extent, std::abs(m_points.back().x), std::abs(m_points.back().y)});
        }
        m_flat = 1e-14 * extent * extent;
        for (std::uint32_t i = 0; i < points.size(); ++i) m_ring.push_back(i);
    }

    Triangles clip() {
        Triangles triangles;
        std::size_t at = 0;
        while (m_ring.size() > 3) {
            const std::size_t ear = findEar(at);
            if (ear == m_ring.size()) break;
            triangles.push_back({point(ear, -1), point(ear, 0), point(ear, 1)});
            m_ring.erase(m_ring.begin() + static_cast<std::ptrdiff_t>(ear));
            at = (ear % m_ring.size() + 1) % m_ring.size();
        }
        for (std::size_t i = 1; i + 1 < m_ring.size(); ++i)
            triangles.push_back({point(at, 0), point(at + i, 0), point(at + i, 1)});
        return triangles;
    }

  private:
    std::uint32_t point(std::size_t at, int step) const {
        const std::size_t n = m_ring.size();
        return m_ring[(at + n + static_cast<std::size_t>(step + 1) - 1) % n];
    }
    double area(std::size_t at) const {
        return orientation(m_points[point(at, -1)], m_points[point(at, 0)], m_points[point(at, 1)]);
    }
    bool isBlocked(std::size_t at, bool closed) const {
        const Point2 a = m_points[point(at, -1)], b = m_points[point(at, 0)],
                     c = m_points[point(at, 1)];
        for (std::size_t i = 0; i < m_ring.size(); ++i) {
            if (area(i) > m_flat) continue;
            const Point2 p = m_points[m_ring[i]];
            const auto same = [&](const Point2& q) { return p.x == q.x && p.y == q.y; };
            if (same(a) || same(b) || same(c)) continue;
            const double least =
                std::min({orientation(a, b, p), orientation(b, c, p), orientation(c, a, p)});
            if (closed ? least >= 0 : least > 0) return true;
        }
        return false;
    }
    std::size_t findEar(std::size_t from) const {
        for (int kind = 0; kind < 3; ++kind)
            for (std::size_t i = 0; i < m_ring.size(); ++i) {
                const std::size_t at = (from + i) % m_ring.size();
                const double own = area(at);
                if (kind == 0   ? own > m_flat && !isBlocked(at, true)
                    : kind == 1 ? std::abs(own) <= m_flat
                                : own > 0 && !isBlocked(at, false))
                    return at;
            }
        return m_ring.size();
    }

    std::vector<Point2> m_points;
    std::vector<std::uint32_t> m_ring;
    double m_flat = 0;
};

std::vector<Vec3d> randomStar(std::mt19937& random, std::uint32_t n) {
    std::uniform_real_distribution<double> radius(0.05, 1.0);
    std::vector<Vec3d> points;
    for (std::uint32_t i = 0; i < n; ++i) {
        const double angle = 2 * 3.14159265358979 * i / n, r = radius(random);
        points.emplace_back(r * std::cos(angle), r * std::sin(angle), 0.0);
    }
    return points;
}

std::vector<Vec3d> spiral(std::uint32_t n) {
    std::vector<Vec3d> points;
    for (std::uint32_t i = 0; i < n; ++i) {
        const std::uint32_t along = i < n / 2 ? i : n - 1 - i;
        const double angle = 20.0 * along / n, r = 1 + angle + (i < n / 2 ? 0.0 : 1.0);
        points.emplace_back(r * std::cos(angle), r * std::sin(angle), 0.0);
    }
    return points;
}

// Corners on a grid: many in line, some twice, most polygons cross themselves.
std::vector<Vec3d> onAGrid(std::mt19937& random, std::uint32_t n) {
    std::uniform_int_distribution<int> place(0, 6);
    std::vector<Vec3d> points;
    for (std::uint32_t i = 0; i < n; ++i) points.emplace_back(place(random), place(random), 0.0);
    return points;
}

void expectTheSame(std::vector<Vec3d> points) {
    const Vec3d normal = newellNormal(points);
    if (normal.z < 0) std::ranges::reverse(points);
    if (normal.z == 0) return;
    Triangles found;
    PolygonClipper().clip(points, found);
    EXPECT_EQ(PlainClipper(points).clip(), found) << points.size() << " corners";
}

TEST(PolygonClipper, FindsTheEarsThatALookAtAllFinds) {
    std::mt19937 random(7);
    for (const std::uint32_t n : {5u, 6u, 9u, 17u, 64u, 65u, 150u}) {
        for (int i = 0; i < 8; ++i) {
            expectTheSame(randomStar(random, n));
            expectTheSame(onAGrid(random, n));
        }
        expectTheSame(spiral(n));
    }
}

// Both diagonals of a rectangle are alike: which is taken hangs on no rounding, and a kite is still
// cut along the shorter.
TEST(PolygonClipper, RectanglesAreCutAlikeWhateverTheRounding) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> off(-1e-7, 1e-7), size(0.1, 10);
    const auto cut = [](const std::vector<Vec3d>& points) {
        Triangles triangles;
        EXPECT_TRUE(PolygonClipper().clip(points, triangles));
        return triangles;
    };
    const Triangles wanted{{0, 1, 2}, {0, 2, 3}};
    for (int i = 0; i < 1000; ++i) {
        const double x = size(random), y = size(random);
        std::vector<Vec3d> points{{0, 0, 1}, {x, 0, 1}, {x, y, 1}, {0, y, 1}};
        for (Vec3d& p : points)
            p = {p.x * (1 + off(random)), p.y * (1 + off(random)), p.z * (1 + off(random))};
        EXPECT_EQ(cut(points), wanted) << i;
    }
    EXPECT_EQ(cut({{0, 0, 0}, {1, -0.4, 0}, {2, 0, 0}, {1, 0.4, 0}}),
              (Triangles{{0, 1, 3}, {1, 2, 3}}));
}

TEST(RingMarks, FindsTheNextAllRound) {
    std::mt19937 random(3);
    for (const std::uint32_t n : {1u, 63u, 64u, 65u, 4097u, 5000u}) {
        RingMarks marks;
        marks.reset(n);
        std::vector<bool> plain(n, true);
        for (int step = 0; step < 3000; ++step) {
            const auto i = static_cast<std::uint32_t>(random() % n);
            const auto from = static_cast<std::uint32_t>(random() % n);
            plain[i] = random() % 16 == 0;
            if (plain[i])
                marks.set(i);
            else
                marks.clear(i);
            std::uint32_t expected = RingMarks::kNone;
            for (std::uint32_t k = 0; k < n && expected == RingMarks::kNone; ++k)
                if (plain[(from + k) % n]) expected = (from + k) % n;
            ASSERT_EQ(expected, marks.firstFrom(from)) << n << " " << step;
        }
    }
}

}  // namespace
}  // namespace pm
