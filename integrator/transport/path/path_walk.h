// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include "integrator/materials/bsdf.h"
#include "integrator/paths/segment.h"
#include "integrator/rays/ray_tracer.h"
#include "integrator/sampling/event_count.h"
#include "integrator/sampling/sampler.h"
#include "integrator/scene/scene.h"
#include "integrator/shapes/ray_footprint.h"
#include "integrator/shapes/surface.h"
#include "integrator/values/rgb.h"

namespace pm {

// What a path from the camera carries on from where it has come.
struct Carried {
    Rgb throughput{1.0f};  // what light found from here on counts for
    // Undoes the factors eta^2 of refraction, which say nothing about what the path will bring.
    float etaScale = 1.0f;

    // Of light found from here on, the share that reaches the camera; 1 where the path begins.
    float amount() const { return maxChannel(throughput) * etaScale; }
    void followLobe(const Bsdf& bsdf, const BsdfSample& sample) {
        throughput *= sample.weight;
        if (isDelta(sample.lobe)) etaScale *= bsdf.etaSquared(sample.lobe);
    }
};

// A path from the camera on its way from surface to surface, with the ray to follow next.
struct PathWalk : Carried {
    Ray ray;
    RayFootprint footprint;  // of the ray

    explicit PathWalk(const Ray& first, const RayFootprint& ofFirst = {})
        : ray(first), footprint(ofFirst) {}

    // Goes on along a sampled direction, by Russian roulette after the first events. False: the
    // path ends here. No random number is drawn where the path is sure to go on. isPart: it divides
    // here, and roulette takes what this part carries for all there is.
    bool scatter(const Surface& surface, const Bsdf& bsdf, const BsdfSample& sample,
                 Sampler& sampler, bool isPart = false);
    // It ended for the number of its events: what it would have found is missing.
    bool isCut() const { return m_isCut; }
    // For caches that it asks.
    CacheUser user() const {
        return m_events.count() > 0 ? CacheUser::kBounce : CacheUser::kCamera;
    }

  private:
    EventCount m_events;
    bool m_isCut = false;
    float m_whole = 1.0f;
};

// A surface, not black, that a camera path has met.
struct PathStop {
    const Ray& ray;  // that led there
    const Surface& surface;
    const Bsdf& bsdf;
    const Rgb& throughput;          // of the path up to here
    const RayFootprint& footprint;  // at the surface
    Lobe next;                      // by which the path would leave
    Sampler& sampler;               // of the path

    // Whether indirect light is gathered here: at the first diffuse surface, and where a broad lobe
    // leads on, along which gather rays look for it.
    bool isGathered() const { return bsdf.has(Lobe::kDiffuse) && !goesOn(); }
    // Whether it may be farther on.
    bool goesOn() const { return next != Lobe::kDiffuse && next != Lobe::kBroad; }
};

// Follows a path from the camera until visit(PathStop) returns false, or it ends as one of any kind
// would. footprint: of the first ray.
template <typename Visit>
void followCameraPath(const Scene& scene, const Ray& first, const RayFootprint& footprint,
                      Sampler& sampler, const Visit& visit) {
    PathWalk path(first, footprint);
    while (true) {
        Surface surface;
        if (!meet(scene, path.ray, surface, &path.footprint, path.throughput)) return;
        const Bsdf bsdf(scene.materials(), surface, -path.ray.direction, Transport::kRadiance,
                        path.throughput);
        if (bsdf.isBlackBody()) return;
        BsdfSample sample;
        const float uLobe = sampler.next1D();
        const bool goesOn = bsdf.sample(uLobe, sampler.next2D(), sample);
        if (!visit(PathStop{path.ray, surface, bsdf, path.throughput, path.footprint, sample.lobe,
                            sampler}) ||
            !goesOn || !path.scatter(surface, bsdf, sample, sampler))
            return;
    }
}

}  // namespace pm
