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

#include "integrator/rays/exact_triangle.h"
#include "integrator/rays/shared_mesh.h"
#include "integrator/shapes/curved_shape.h"
#include "integrator/tessellation/limit_groups.h"
#include "integrator/values/cancel_check.h"
#include "integrator/values/ray.h"
#include "integrator/values/transform.h"
#include "integrator/values/vec.h"

namespace pm {

// Nearest hits and visibility among triangle meshes, limit surfaces and spheres, by Embree in its
// robust mode. Every ray is checked first for what would end the process inside Embree: NaN,
// infinity, distances beyond kLargestCoordinate; such a ray meets nothing, and as a shadow ray it
// is occluded.
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

    // Shapes are copied (curved ones) or referred to (meshes: positions must stay until
    // destruction, and must be followed by at least 4 readable bytes, which a spare last element
    // gives). exact: those of the triangles that are to be intersected in double, copied. seenBy:
    // rays that meet them.
    std::uint32_t addTriangles(std::span<const Vec3f> positions,
                               std::span<const std::array<std::uint32_t, 3>> triangles,
                               std::span<const ExactTriangle> exact = {},
                               Viewers seenBy = kAllRays);
    std::uint32_t addCurved(const CurvedShape& shape, Viewers seenBy = kAllRays);
    // groups: must stay until destruction. A ray that meets a group's box makes it, or waits for
    // it; what that throws goes on to who asked.
    std::uint32_t addGroups(const LimitGroups& groups, Viewers seenBy = kAllRays);
    // mesh: of this tracer's instruction set. toScene: object to scene, of any scale but 0.
    std::uint32_t addInstance(std::shared_ptr<const SharedMesh> mesh, const Transform& toScene,
                              Viewers seenBy = kAllRays);

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
    // Calls visit(hit) for every triangle of a mesh that the ray meets beyond tMin, in no order.
    template <typename Visit>
    void forEachHit(const Ray& ray, float tMin, const Visit& visit) const {
        auto visitAll = [&](const RayHit& hit) {
            visit(hit);
            return false;
        };
        using All = decltype(visitAll);
        visitHits(
            ray, tMin,
            [](void* user, const RayHit& hit) { return (*static_cast<All*>(user))(hit); },
            &visitAll);
    }

    // What "best" came to; part of a render's identity.
    const std::string& isa() const;
    // Without shared meshes.
    std::uint64_t memoryBytes() const;

  private:
    using HitQuestion = bool (*)(void* user, const RayHit& hit);
    bool askEach(const Ray& ray, HitQuestion stops, void* user) const;
    void visitHits(const Ray& ray, float tMin, HitQuestion visit, void* user) const;

    struct Impl;
    std::unique_ptr<Impl> m_impl;
};

}  // namespace pm
