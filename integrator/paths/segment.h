// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include "integrator/sampling/event_count.h"
#include "integrator/scene/scene.h"
#include "integrator/shapes/ray_footprint.h"
#include "integrator/shapes/surface.h"
#include "integrator/values/rgb.h"

namespace pm {

// How light comes along a ray. All that follows light asks here, and nobody but this file asks
// Scene::intersect() for it: so no path forgets what media absorb.

// What a ray meets first. carried: throughput or flux, of which what the media on the way leave is
// left. footprint: of the ray, becomes that at the surface; may be null. False: it meets nothing.
inline bool meet(const Scene& scene, const Ray& ray, Surface& surface, RayFootprint* footprint,
                 Rgb& carried) {
    if (!scene.intersect(ray, surface, footprint)) return false;
    carried *= scene.leftAlong(ray, surface);
    return true;
}

// Goes straight on along a ray, through all that lets light pass: calls
// visit(const Surface* met, const Rgb& left) for each surface, nearest first, and with null where
// there is none; left: the share of what comes from there. visit returns whether to go on.
// passes(surface): whether the ray passes it as if it were not there.
template <typename Visit, typename Passes>
void goStraight(const Scene& scene, const Ray& first, RayFootprint footprint, const Visit& visit,
                const Passes& passes) {
    Rgb left(1.0f);
    EventCount events;
    Ray ray = first;
    while (!events.isOver()) {
        Surface surface;
        const bool isMet = meet(scene, ray, surface, &footprint, left);
        if (!visit(isMet ? &surface : nullptr, left) || !isMet) return;
        if (!passes(surface)) {
            left *= scene.straightShare(surface, ray.direction);
            if (isBlack(left)) return;
        }
        events.add(left.g);
        ray.origin = rayOrigin(surface, first.direction);
        ray.tMax = first.tMax - dot(ray.origin - first.origin, first.direction);
        if (!(ray.tMax > 0.0f)) return;
    }
}

}  // namespace pm
