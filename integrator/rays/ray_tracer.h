// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "integrator/values/cancel_check.h"
#include "integrator/values/vec.h"

namespace pm {

// A ray in the scene's own coordinates (its centre at the origin). The direction need not have unit
// length; distances are in units of its length.
struct Ray {
    Vec3f origin;
    Vec3f direction;
    float tMax = std::numeric_limits<float>::infinity();
};

// The primitive that a ray meets first. Where exactly it is met is computed again from the
// primitive.
struct RayHit {
    std::uint32_t shape = 0;      // in the order in which shapes were added
    std::uint32_t primitive = 0;  // triangle of that shape; 0 for spheres
    float t = 0.0f;
    bool isPane = false;  // see Surface; never set by the tracer
};

// A triangle that is intersected in double: one so huge that float's roundings of it matter.
struct ExactTriangle {
    std::uint32_t primitive = 0;  // its number in its shape
    std::array<Vec3d, 3> corners;
};

// Nearest hits and visibility among triangle meshes and spheres, by Embree in its robust mode.
// Every ray is checked first for what would end the process inside Embree: NaN, infinity, distances
// beyond kLargestCoordinate; such a ray meets nothing, and as a shadow ray it is occluded.
class RayTracer {
  public:
    static constexpr float kLargestCoordinate = 1e18f;

    // isa: "best" or one of sse2, sse4.2, avx, avx2, avx512. Throws Error(kInvalidArgument) for
    // others and for one that this processor lacks, Error(kOutOfMemory, kInternal) when Embree
    // fails.
    explicit RayTracer(const std::string& isa);
    ~RayTracer();
    RayTracer(const RayTracer&) = delete;
    RayTracer& operator=(const RayTracer&) = delete;

    // Shapes are copied (spheres) or referred to (meshes: positions must stay until destruction,
    // and must be followed by at least 4 readable bytes, which a spare last element gives).
    // exact: those of the triangles that are to be intersected in double, copied.
    std::uint32_t addTriangles(std::span<const Vec3f> positions,
                               std::span<const std::array<std::uint32_t, 3>> triangles,
                               std::span<const ExactTriangle> exact = {});
    std::uint32_t addSphere(const Vec3d& centre, double radius);

    // Builds; in parallel in the calling TBB arena. Throws Error(kOutOfMemory, kInternal,
    // kCancelled).
    void commit(const CancelCheck& cancel = {});

    // Threads: any, at once, after commit.
    bool intersect(const Ray& ray, RayHit& hit) const;
    bool occluded(const Ray& ray) const;
    // Calls stops(hit) for all that the ray meets, every root of a sphere too, in no order, until
    // one stops it. True: one did. What stops throws goes on to the caller.
    template <typename Stops>
    bool stopped(const Ray& ray, Stops&& stops) const {
        using Plain = std::remove_reference_t<Stops>;
        return askEach(
            ray, [](void* user, const RayHit& hit) { return (*static_cast<Plain*>(user))(hit); },
            &stops);
    }
    // Calls visit(hit) for every triangle that the ray meets beyond tMin, in no order. Spheres are
    // left out.
    template <typename Visit>
    void forEachHit(const Ray& ray, float tMin, const Visit& visit) const {
        visitHits(
            ray, tMin,
            [](const void* user, const RayHit& hit) { (*static_cast<const Visit*>(user))(hit); },
            &visit);
    }

    // What "best" came to; part of a render's identity.
    const std::string& isa() const;
    std::uint64_t memoryBytes() const;

  private:
    using HitVisitor = void (*)(const void* user, const RayHit& hit);
    using HitQuestion = bool (*)(void* user, const RayHit& hit);
    bool askEach(const Ray& ray, HitQuestion stops, void* user) const;
    void visitHits(const Ray& ray, float tMin, HitVisitor visit, const void* user) const;

    struct Impl;
    std::unique_ptr<Impl> m_impl;
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

// The nearest root in (0, tMax], or a negative number.
double intersectSphere(const Vec3d& origin, const Vec3d& direction, double tMax,
                       const Vec3d& centre, double radius);

}  // namespace pm
