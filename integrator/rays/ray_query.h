// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <embree3/rtcore.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <exception>
#include <limits>
#include <span>

#include "integrator/shapes/roots.h"
#include "integrator/values/ray.h"
#include "integrator/values/transform.h"
#include "integrator/values/vec.h"

namespace pm {

// What goes with a ray through Embree, in place of its own context.
struct RayQuery {
    RTCIntersectContext context;  // first: Embree hands a pointer to it back
    const Ray& ray;               // as it was asked for, whatever instance Embree is in
    // Object to scene, of each shape that is an instance.
    std::span<const Transform* const> placements;
    // Of rays that look for all that they meet: asked of each, whether it stops the ray.
    bool (*stops)(void* user, const RayHit& hit) = nullptr;
    void* user = nullptr;
    bool withCurved = true;     // spheres, too
    std::exception_ptr thrown;  // Embree's own functions can't be left by an exception

    RayQuery(const Ray& asked, std::span<const Transform* const> of) : ray(asked), placements(of) {
        rtcInitIntersectContext(&context);
    }

    bool wantsAll() const { return stops != nullptr; }
    bool isStoppedBy(const RayHit& hit) {
        try {
            return thrown || stops(user, hit);
        } catch (...) {
            thrown = std::current_exception();
            return true;
        }
    }
    // That of the instance that Embree is in, or of the geometry itself.
    std::uint32_t shapeOr(std::uint32_t geometry) const {
        const std::uint32_t instance = context.instID[0];
        return instance == RTC_INVALID_GEOMETRY_ID ? geometry : instance;
    }
    static RayQuery& of(RTCIntersectContext* context) {
        return *reinterpret_cast<RayQuery*>(context);
    }
};

// Embree's functions for a kind of shape of ours. Rays are traced one by one, so N is 1 and a
// packet is a plain RTCRay or RTCRayHit. A kind has
//   kIsCurved                        whether it is left out where RayQuery::withCurved is false,
//   bounds(primitive, RTCBounds&)    in the space of its geometry, rounded outwards,
//   roots(primitive, query, RTCRay)  of all the line, in units of the ray's direction,
//   name(primitive, geometry)        what hits of it are told as.
template <typename Kind>
struct UserGeometry {
    static void bounds(const RTCBoundsFunctionArguments* args) {
        static_cast<const Kind*>(args->geometryUserPtr)->bounds(args->primID, *args->bounds_o);
    }
    static void intersect(const RTCIntersectFunctionNArguments* args) {
        if (args->valid[0] != -1) return;
        auto& rayHit = *reinterpret_cast<RTCRayHit*>(args->rayhit);
        RayQuery& query = RayQuery::of(args->context);
        if (query.wantsAll() && Kind::kIsCurved && !query.withCurved) return;
        const auto& kind = *static_cast<const Kind*>(args->geometryUserPtr);
        const RayRoots roots = kind.roots(args->primID, query, rayHit.ray);
        for (std::uint32_t i = 0; i < roots.count; ++i) {
            const double t = roots.t[i];
            if (!isOn(rayHit.ray, t)) continue;
            RayHit hit = kind.name(args->primID, query.shapeOr(args->geomID));
            hit.t = static_cast<float>(t);
            if (query.wantsAll()) {
                query.isStoppedBy(hit);
                continue;
            }
            rayHit.ray.tfar = hit.t;
            rayHit.hit = {};
            rayHit.hit.Ng_x = 1.0f;
            rayHit.hit.geomID = hit.shape;
            rayHit.hit.primID = hit.primitive;
            rayHit.hit.instID[0] = args->context->instID[0];
            return;
        }
    }
    static void occluded(const RTCOccludedFunctionNArguments* args) {
        if (args->valid[0] != -1) return;
        auto& ray = *reinterpret_cast<RTCRay*>(args->ray);
        RayQuery& query = RayQuery::of(args->context);
        const auto& kind = *static_cast<const Kind*>(args->geometryUserPtr);
        const RayRoots roots = kind.roots(args->primID, query, ray);
        for (std::uint32_t i = 0; i < roots.count; ++i) {
            if (!isOn(ray, roots.t[i])) continue;
            if (query.wantsAll()) {
                RayHit hit = kind.name(args->primID, query.shapeOr(args->geomID));
                hit.t = static_cast<float>(roots.t[i]);
                if (!query.isStoppedBy(hit)) continue;
            }
            ray.tfar = -std::numeric_limits<float>::infinity();
            return;
        }
    }

  private:
    static bool isOn(const RTCRay& ray, double t) {
        return t > 0.0 && t >= static_cast<double>(ray.tnear) &&
               t <= std::min<double>(ray.tfar, std::numeric_limits<float>::max());
    }
};

// Rounded outwards: the box must hold what it is of in double. margin: more, scene units.
inline void setBounds(RTCBounds& bounds, const Vec3d& lo, const Vec3d& hi, double margin = 0.0) {
    const auto down = [&](double v) {
        return std::nextafter(static_cast<float>(v - margin),
                              -std::numeric_limits<float>::infinity());
    };
    const auto up = [&](double v) {
        return std::nextafter(static_cast<float>(v + margin),
                              std::numeric_limits<float>::infinity());
    };
    bounds.lower_x = down(lo.x);
    bounds.lower_y = down(lo.y);
    bounds.lower_z = down(lo.z);
    bounds.upper_x = up(hi.x);
    bounds.upper_y = up(hi.y);
    bounds.upper_z = up(hi.z);
}

}  // namespace pm
