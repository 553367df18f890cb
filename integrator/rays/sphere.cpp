// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/rays/sphere.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace pm {

bool findSphereRoots(const Vec3d& origin, const Vec3d& direction, const Vec3d& centre,
                     double radius, SphereRoots& roots) {
    const Vec3d f = origin - centre;
    const double a = lengthSquared(direction);
    if (!(a > 0.0)) return false;
    const double b = -dot(f, direction);
    const double f2 = lengthSquared(f), c = f2 - radius * radius;
    // Most misses need no division: the sphere lies behind, or the line passes it by more than
    // these few terms' roundings, 2^-52 each of a f2, can amount to.
    if (b < 0.0 && c > 0.0) return false;
    if (a * c - b * b > 0x1p-46 * a * f2) return false;
    // The squared distance of the ray's line from the centre, without cancellation for far spheres.
    const Vec3d nearest = f + direction * (b / a);
    const double discriminant = radius * radius - lengthSquared(nearest);
    if (discriminant < 0.0) return false;
    const double q = b + std::copysign(std::sqrt(a * discriminant), b);
    if (q == 0.0) return false;  // the origin is on the sphere and the ray touches it
    roots = {c / q, q / a};
    if (roots.near > roots.far) std::swap(roots.near, roots.far);
    return true;
}

double intersectSphere(const Vec3d& origin, const Vec3d& direction, double tMax,
                       const Vec3d& centre, double radius) {
    SphereRoots roots;
    if (!findSphereRoots(origin, direction, centre, radius, roots)) return -1.0;
    const double t = roots.near > 0.0 ? roots.near : roots.far;
    return t > 0.0 && t <= tMax ? t : -1.0;
}

}  // namespace pm
