// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// Triangulates one polygon. Quads are cut along the better diagonal, larger polygons by ear
// clipping [1] on the plane of their Newell normal [2], with an orientation test whose sign is
// right for the coordinates given.
// [1] G. H. Meisters, Polygons have ears, 1975.
// [2] Sutherland, Sproull, Schumacker, A characterization of ten hidden-surface algorithms, 1974.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "integrator/geometry/polygon_mesh.h"
#include "integrator/geometry/reflex_points.h"
#include "integrator/geometry/ring_marks.h"
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
    // How much an ear may ask for: the stricter are tried first.
    enum class Ear : std::uint32_t { kClear, kFlat, kTouched };
    static constexpr std::uint32_t kEars = 3;
    // A corner that is no ear of that kind while another one stands in its way.
    struct Wait {
        std::uint32_t corner;
        Ear kind;
        std::uint32_t next;  // in m_waits, for the same other one
    };

    bool clipQuad(std::span<const Vec3d> points,
                  std::vector<TriangleMesh::Corners>& triangles) const;
    bool clipRing(std::vector<TriangleMesh::Corners>& triangles);
    void project(std::span<const Vec3d> points, const Vec3d& normal);
    void linkRing();
    double areaAt(std::uint32_t corner) const;
    void classify(std::uint32_t corner);
    std::uint32_t findEar(std::uint32_t from, Ear kind);
    bool isEar(std::uint32_t corner, Ear kind);
    bool isFree(std::uint32_t corner, Ear kind);
    void endWaitsFor(std::uint32_t corner);
    std::uint32_t remove(std::uint32_t corner);

    std::vector<Point2> m_points;
    std::vector<std::uint32_t> m_next, m_previous;
    double m_flatArea = 0;  // twice the area below which three points are in line
    ReflexPoints m_reflex;
    // What may be an ear of each kind: all that was not found to be none since its neighbours, or
    // what stood in its way, changed.
    std::array<RingMarks, kEars> m_maybe;
    std::vector<Wait> m_waits;
    std::vector<std::uint32_t> m_firstWait;  // for each corner, or kNone
};

}  // namespace pm
