// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include "integrator/values/vec.h"

namespace pm {

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

// The nearest root in (0, tMax], or a negative number.
double intersectSphere(const Vec3d& origin, const Vec3d& direction, double tMax,
                       const Vec3d& centre, double radius);

}  // namespace pm
