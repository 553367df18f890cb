// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// What Embree asks about groups of triangles that are made when a ray meets their box: one
// primitive of its own for each group.
#pragma once

#include <embree3/rtcore.h>

#include <algorithm>
#include <exception>
#include <limits>

#include "integrator/rays/ray_query.h"
#include "integrator/tessellation/limit_groups.h"

namespace pm {

struct GroupShape {
    const LimitGroups* groups;

    static void bounds(const RTCBoundsFunctionArguments* args) {
        const Box3d& box =
            static_cast<const GroupShape*>(args->geometryUserPtr)->groups->box(args->primID);
        setBounds(*args->bounds_o, box.lo, box.hi);
    }

    static void intersect(const RTCIntersectFunctionNArguments* args) {
        if (args->valid[0] != -1) return;
        auto& rayHit = *reinterpret_cast<RTCRayHit*>(args->rayhit);
        RayQuery& query = RayQuery::of(args->context);
        if (query.wantsAll() && !query.withCurved) return;
        guarded(query, [&] {
            if (query.wantsAll()) {
                visitAll(args->geometryUserPtr, args->primID, args->geomID, rayHit.ray, query);
                return;
            }
            const LimitGroups& groups = of(args->geometryUserPtr);
            TriangleGroup::Hit hit;
            const ShearedRay ray = sheared(rayHit.ray);
            const double tNear = nearEnd(rayHit.ray), tFar = farEnd(rayHit.ray);
            const GroupCache::Pin group = groups.pinFor(args->primID, ray, tNear, tFar);
            if (!group || !group->nearest(ray, tNear, tFar, hit)) return;
            rayHit.ray.tfar = static_cast<float>(hit.t);
            rayHit.hit = {};
            rayHit.hit.Ng_x = 1.0f;
            rayHit.hit.geomID = args->geomID;
            rayHit.hit.primID = groups.firstTriangle(args->primID) + hit.triangle;
            rayHit.hit.instID[0] = args->context->instID[0];
        });
    }

    static void occluded(const RTCOccludedFunctionNArguments* args) {
        if (args->valid[0] != -1) return;
        auto& rtcRay = *reinterpret_cast<RTCRay*>(args->ray);
        RayQuery& query = RayQuery::of(args->context);
        bool isOccluded = true;  // where it can't be found out
        guarded(query, [&] {
            if (query.wantsAll()) {
                isOccluded =
                    visitAll(args->geometryUserPtr, args->primID, args->geomID, rtcRay, query);
                return;
            }
            const LimitGroups& groups = of(args->geometryUserPtr);
            const ShearedRay ray = sheared(rtcRay);
            const double tNear = nearEnd(rtcRay);
            double tFar = farEnd(rtcRay);
            const GroupCache::Pin group = groups.pinFor(args->primID, ray, tNear, tFar);
            isOccluded =
                group && group->walk(ray, tNear, tFar, [](std::uint32_t, double) { return true; });
        });
        if (isOccluded) rtcRay.tfar = -std::numeric_limits<float>::infinity();
    }

  private:
    static const LimitGroups& of(void* user) {
        return *static_cast<const GroupShape*>(user)->groups;
    }
    static ShearedRay sheared(const RTCRay& ray) {
        return {{ray.org_x, ray.org_y, ray.org_z}, {ray.dir_x, ray.dir_y, ray.dir_z}};
    }
    // Never 0 itself, where the ray starts.
    static double nearEnd(const RTCRay& ray) {
        return std::max(static_cast<double>(ray.tnear), std::numeric_limits<double>::min());
    }
    static double farEnd(const RTCRay& ray) {
        return std::min<double>(ray.tfar, std::numeric_limits<float>::max());
    }
    // Embree's own functions can't be left by an exception; a ray without direction meets nothing.
    template <typename Do>
    static void guarded(RayQuery& query, const Do& act) {
        if (query.thrown || query.ray.direction == Vec3f(0.0f)) return;
        try {
            act();
        } catch (...) {
            query.thrown = std::current_exception();
        }
    }
    static bool visitAll(void* user, std::uint32_t number, std::uint32_t geometry,
                         const RTCRay& rtcRay, RayQuery& query) {
        const LimitGroups& groups = of(user);
        const ShearedRay ray = sheared(rtcRay);
        const double tNear = nearEnd(rtcRay);
        double tFar = farEnd(rtcRay);
        const GroupCache::Pin group = groups.pinFor(number, ray, tNear, tFar);
        return group && group->walk(ray, tNear, tFar, [&](std::uint32_t triangle, double t) {
            return query.isStoppedBy(
                {geometry, groups.firstTriangle(number) + triangle, static_cast<float>(t)});
        });
    }
};

}  // namespace pm
