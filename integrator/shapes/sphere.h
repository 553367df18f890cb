// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>
#include <string>

#include "integrator/shapes/roots.h"
#include "integrator/shapes/surface.h"
#include "integrator/values/box.h"
#include "integrator/values/transform.h"
#include "integrator/values/vec.h"

namespace pm {

class PlacedSphere;

// An analytic sphere in object space; its front is outside. Under rotation, translation and uniform
// scale it is a PlacedSphere, under others an ellipsoid, which is no lamp. Textures are
// latitude-longitude pictures: in object space their middle is towards +z, their right half towards
// +x, their upper edge at +y; so a camera that isn't turned sees the middle as it is.
struct SphereShape {
    using Placed = PlacedSphere;
    static constexpr const char* kName = "sphere";

    Vec3d centre;
    double radius = 1.0;  // > 0, scene units

    // See ObjectShape.
    RayRoots roots(const Vec3d& origin, const Vec3d& direction) const;
    Vec3d onto(const Vec3d& point) const { return centre + normalize(point - centre) * radius; }
    Vec3d normalAt(const Vec3d& point) const { return point - centre; }
    Vec2f uvAt(const Vec3d& point) const;
    Box3d boundsUnder(const Transform& transform) const;
    double areaUnder(const Transform& transform) const;
    // Throws Error(kInvalidScene).
    void check(const std::string& name) const;
};

// Where a line meets a sphere, near before far, in units of the direction's length: either may be
// outside the ray.
struct SphereRoots {
    double near, far;
};

// Intersects a line with a sphere in double precision; false: it passes the sphere, or touches it
// at its origin. Source: Haines et al., "Precision Improvements for Ray/Sphere Intersection", Ray
// Tracing Gems, 2019 (the stable quadratic).
bool findSphereRoots(const Vec3d& origin, const Vec3d& direction, const Vec3d& centre,
                     double radius, SphereRoots& roots);

inline RayRoots SphereShape::roots(const Vec3d& origin, const Vec3d& direction) const {
    RayRoots roots;
    SphereRoots both;
    if (!findSphereRoots(origin, direction, centre, radius, both)) return roots;
    roots.add(both.near);
    roots.add(both.far);
    return roots;
}

// The nearest root in (0, tMax], or a negative number.
double intersectSphere(const Vec3d& origin, const Vec3d& direction, double tMax,
                       const Vec3d& centre, double radius);

// A sphere where it stands; see CurvedShape. position: of centre, scene's own coordinates.
class PlacedSphere {
  public:
    // origin: of the scene's own coordinates, world. hasTexture: its points are asked for uv. name:
    // of the instance, for errors. toWorld keeps spheres spheres. Throws Error(kInvalidScene).
    PlacedSphere(const SphereShape& sphere, const Transform& toWorld, const Vec3d& origin,
                 bool hasTexture, const std::string& name);

    const SphereShape& sphere() const { return m_sphere; }
    Box3d bounds() const {
        return {m_sphere.centre - Vec3d(m_sphere.radius), m_sphere.centre + Vec3d(m_sphere.radius)};
    }
    double size() const { return 2 * m_sphere.radius; }
    double area() const;
    RayRoots roots(const Vec3d& origin, const Vec3d& direction) const {
        return m_sphere.roots(origin, direction);
    }
    void surfaceNear(const Vec3d& point, Surface& surface) const {
        surfaceAlong(point - m_sphere.centre, surface);
    }
    // Of the point that lies in a direction (of any length) from the centre.
    void surfaceAlong(const Vec3d& direction, Surface& surface) const;
    // The direction of a point of the texture.
    Vec3d directionOf(Vec2f uv) const;

  private:
    SphereShape m_sphere;
    Vec3d m_axes[3];  // of its object space, unit
    bool m_hasTexture;
};

}  // namespace pm
