// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// The kinds of shapes that Embree asks functions of ours about.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "integrator/rays/exact_triangle.h"
#include "integrator/rays/ray_query.h"
#include "integrator/shapes/curved_shape.h"

namespace pm {

struct UserCurved {
    static constexpr bool kIsCurved = true;

    CurvedShape shape;

    void bounds(std::uint32_t, RTCBounds& bounds) const {
        const Box3d box = shape.bounds();
        setBounds(bounds, box.lo, box.hi);
    }
    RayRoots roots(std::uint32_t, const RayQuery&, const RTCRay& ray) const {
        return shape.roots({ray.org_x, ray.org_y, ray.org_z}, {ray.dir_x, ray.dir_y, ray.dir_z});
    }
    RayHit name(std::uint32_t primitive, std::uint32_t geometry) const {
        return {geometry, primitive};
    }
};

// The distance along a ray to a triangle, or NaN or infinity for no hit. Which side of an edge the
// ray passes comes of the edge's two ends alone, so that nothing slips through between neighbours.
inline double distanceToTriangle(const Vec3d& origin, const Vec3d& direction,
                                 const std::array<Vec3d, 3>& corners) {
    const Vec3d a = corners[0] - origin, b = corners[1] - origin, c = corners[2] - origin;
    const double u = dot(direction, cross(c, b)), v = dot(direction, cross(a, c)),
                 w = dot(direction, cross(b, a));
    if (std::min({u, v, w}) < 0.0 && std::max({u, v, w}) > 0.0)
        return std::numeric_limits<double>::quiet_NaN();
    const Vec3d normal = cross(corners[1] - corners[0], corners[2] - corners[0]);
    // Of what is seen edge-on not a number.
    return dot(normal, a) / dot(normal, direction);
}

inline void boundsOfTriangle(const std::array<Vec3d, 3>& corners, double margin,
                             RTCBounds& bounds) {
    Vec3d lo = corners[0], hi = lo;
    for (const Vec3d& corner : corners)
        for (int axis = 0; axis < 3; ++axis) {
            lo[axis] = std::min(lo[axis], corner[axis]);
            hi[axis] = std::max(hi[axis], corner[axis]);
        }
    setBounds(bounds, lo, hi, margin);
}

// Those of a shape's triangles that are intersected in double.
struct ExactTriangles {
    static constexpr bool kIsCurved = false;

    std::uint32_t shape;
    std::vector<ExactTriangle> triangles;
    Viewers seenBy = kAllRays;

    void bounds(std::uint32_t primitive, RTCBounds& bounds) const {
        boundsOfTriangle(triangles[primitive].corners, 0.0, bounds);
    }
    RayRoots roots(std::uint32_t primitive, const RayQuery&, const RTCRay& ray) const {
        RayRoots roots;
        roots.add(distanceToTriangle({ray.org_x, ray.org_y, ray.org_z},
                                     {ray.dir_x, ray.dir_y, ray.dir_z},
                                     triangles[primitive].corners));
        return roots;
    }
    RayHit name(std::uint32_t primitive, std::uint32_t) const {
        return {shape, triangles[primitive].primitive};
    }
};

// Those at the rim of an instanced mesh that is open: intersected once more, in double and in the
// scene's own coordinates. What two instances have an edge of in common leaves no gap there,
// whatever float makes of the ray in the space of each. Corners: object space.
struct RimTriangles {
    static constexpr bool kIsCurved = false;

    std::vector<ExactTriangle> triangles;
    double margin;  // of bounds, for rays that were rounded in object space; object's units

    void bounds(std::uint32_t primitive, RTCBounds& bounds) const {
        boundsOfTriangle(triangles[primitive].corners, margin, bounds);
    }
    RayRoots roots(std::uint32_t primitive, const RayQuery& query, const RTCRay&) const {
        RayRoots roots;
        const Transform& toScene = *query.placements[query.context.instID[0]];
        std::array<Vec3d, 3> corners = triangles[primitive].corners;
        for (Vec3d& corner : corners) corner = transformPoint(toScene, corner);
        roots.add(distanceToTriangle(Vec3d(query.ray.origin), Vec3d(query.ray.direction), corners));
        return roots;
    }
    RayHit name(std::uint32_t primitive, std::uint32_t geometry) const {
        return {geometry, triangles[primitive].primitive};
    }
};

}  // namespace pm
