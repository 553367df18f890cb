// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Triangulates one polygon. Quads are cut along the better diagonal, larger polygons by ear
// clipping [1] on the plane of their Newell normal [2], with an orientation test whose sign is
// right for the coordinates given.
// [1] G. H. Meisters, Polygons have ears, 1975.
// [2] Sutherland, Sproull, Schumacker, A characterization of ten hidden-surface algorithms, 1974.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "integrator/geometry/polygon_mesh.h"
#include "integrator/values/vec.h"

namespace pm {

// The sum of the cross products of a closed polygon's edges: along its normal, with twice its area
// as length. Zero for a polygon that cancels itself out.
Vec3d newellNormal(std::span<const Vec3d> points);

// Cuts polygons into triangles. Keeps its scratch memory from one polygon to the next; one thread.
class PolygonClipper {
  public:
    // Appends exactly points.size() - 2 triangles (numbers of points, in the polygon's winding) to
    // `triangles`. For a polygon that does not cross itself, their areas add up to its own.
    // Returns false when it crosses itself (or is not planar enough), so that what could not be
    // cut is a fan. At least 3 points, all finite.
    bool clip(std::span<const Vec3d> points, std::vector<TriangleMesh::Corners>& triangles);

  private:
    struct Point2 {
        double x, y;
    };
    // How much an ear may ask for: the stricter are tried first.
    enum class Ear { kClear, kFlat, kTouched };

    bool clipQuad(std::span<const Vec3d> points,
                  std::vector<TriangleMesh::Corners>& triangles) const;
    bool clipRing(std::vector<TriangleMesh::Corners>& triangles);
    void project(std::span<const Vec3d> points, const Vec3d& normal);
    void linkRing();
    double orientation(std::uint32_t a, std::uint32_t b, std::uint32_t c) const;
    void classify(std::uint32_t corner);
    bool isEar(std::uint32_t corner, Ear kind) const;
    bool containsReflexPoint(std::uint32_t corner, bool closed) const;
    std::uint32_t remove(std::uint32_t corner);

    std::vector<Point2> m_points;
    std::vector<std::uint32_t> m_next, m_previous;
    std::vector<std::uint32_t> m_reflex;      // corners that are not convex
    std::vector<std::uint32_t> m_reflexSlot;  // where each corner is in m_reflex, or kNoSlot
    double m_flatArea = 0;                    // twice the area below which three points are in line
};

}  // namespace pm
