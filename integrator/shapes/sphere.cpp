// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "integrator/shapes/sphere.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "integrator/sampling/pinned_math.h"
#include "integrator/sampling/warps.h"
#include "integrator/shapes/instance_transform.h"
#include "integrator/values/error.h"

namespace pm {

namespace {

// Where in a latitude-longitude picture a point of a sphere lies; see SphereShape.
Vec2f textureOnSphere(const Vec3d (&axes)[3], const Vec3d& normal) {
    const double x = dot(axes[0], normal), y = dot(axes[1], normal), z = dot(axes[2], normal);
    return {static_cast<float>(0.5 + pinnedAtan2Turns(x, z)),
            static_cast<float>(2.0 * pinnedAtan2Turns(std::sqrt(x * x + z * z), -y))};
}

}  // namespace

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

void SphereShape::check(const std::string& name) const {
    if (!(radius > 0) || !std::isfinite(radius) || !isFinite(centre))
        throw Error(
            Status::kInvalidScene,
            fmt::format("sphere '{}' has radius {}; it must be > 0 and finite", name, radius));
}

Vec2f SphereShape::uvAt(const Vec3d& point) const {
    constexpr Vec3d kAxes[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    return textureOnSphere(kAxes, normalize(point - centre));
}

// An ellipsoid reaches as far along an axis as the matrix's row is long.
Box3d SphereShape::boundsUnder(const Transform& m) const {
    const Vec3d middle = transformPoint(m, centre);
    const Vec3d reach = Vec3d{length(row(m, 0)), length(row(m, 1)), length(row(m, 2))} * radius;
    return {middle - reach, middle + reach};
}

// The mean of what areas become, over points whose heights and turns are even.
double SphereShape::areaUnder(const Transform& m) const {
    constexpr int kSide = 64;
    const NormalTransform normals(m);
    double sum = 0;
    for (int i = 0; i < kSide; ++i)
        for (int j = 0; j < kSide; ++j) {
            const double z = 1 - (2 * i + 1.0) / kSide, r = std::sqrt(1 - z * z);
            const SinCos turn = sinCosTurns((static_cast<float>(j) + 0.5f) / kSide);
            const Vec3d n{r * static_cast<double>(turn.cos), r * static_cast<double>(turn.sin), z};
            sum += length(
                Vec3d{dot(normals.rows[0], n), dot(normals.rows[1], n), dot(normals.rows[2], n)});
        }
    return 4 * std::numbers::pi * radius * radius * sum / (kSide * kSide);
}

PlacedSphere::PlacedSphere(const SphereShape& sphere, const Transform& toWorld, const Vec3d& origin,
                           bool hasTexture, const std::string& name)
    : m_hasTexture(hasTexture) {
    sphere.check(name);
    const double scale = uniformScale(toWorld);
    m_sphere.centre = transformPoint(toWorld, sphere.centre) - origin;
    m_sphere.radius = sphere.radius * scale;
    for (std::size_t i = 0; i < 3; ++i)
        m_axes[i] = normalize(Vec3d{toWorld[i], toWorld[i + 4], toWorld[i + 8]});
}

double PlacedSphere::area() const {
    return 4 * std::numbers::pi * m_sphere.radius * m_sphere.radius;
}

void PlacedSphere::surfaceAlong(const Vec3d& direction, Surface& surface) const {
    const Vec3d n = normalize(direction);
    surface.position = Vec3f(m_sphere.centre + n * m_sphere.radius);
    // It is intersected in double from a float origin, so that only roundings to float count.
    surface.offset = 2.0f * surfaceOffset(surface.position, 0.0f);
    surface.geometricNormal = surface.shadingNormal = Vec3f(n);
    surface.uv = m_hasTexture ? textureOnSphere(m_axes, n) : Vec2f{};
}

Vec3d PlacedSphere::directionOf(Vec2f uv) const {
    const SinCos turn = sinCosTurns(uv.x - 0.5f), up = sinCosTurns(0.5f * uv.y);
    const Vec3d local(Vec3f{up.sin * turn.sin, -up.cos, up.sin * turn.cos});
    return m_axes[0] * local.x + m_axes[1] * local.y + m_axes[2] * local.z;
}

}  // namespace pm
