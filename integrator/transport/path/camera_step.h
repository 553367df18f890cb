// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include "integrator/paths/walk.h"

namespace pm {

// A path from the camera, or from where light is gathered, on its way.
struct CameraStep : PathStep {
    // Undoes the factors eta^2 of refraction, which say nothing about what the path will bring.
    float etaScale = 1.0f;

    CameraStep(const Ray& first, const RayFootprint& ofFirst, const Sampler& sampler)
        : PathStep{first, ofFirst, sampler} {}

    // Of light found from here on, the share that reaches the camera; 1 where the path begins.
    float amount() const { return maxChannel(carried) * etaScale; }
    void takeLobe(const BsdfSample& sample) {
        carried *= sample.weight;
        etaScale *= sample.etaSquared;
    }
    // Along a sample whose lobe was taken.
    void leave(const Surface& surface, const Bsdf& bsdf, const BsdfSample& sample);

    // Both, by Russian roulette after the first events. False: the path ends here. isPart: it
    // divides here, and roulette takes what this part carries for all there is.
    bool scatter(const Surface& surface, const Bsdf& bsdf, const BsdfSample& sample,
                 bool isPart = false);
    // What it carries over what roulette takes for all there is: weights of samples have raised it.
    float excess() const { return amount() / m_whole; }
    // It ended for the number of its events: what it would have found is missing.
    bool isCut() const { return m_isCut; }
    // For caches that it asks.
    CacheUser user() const { return events.count() > 0 ? CacheUser::kBounce : CacheUser::kCamera; }

  private:
    bool m_isCut = false;
    float m_whole = 1.0f;
};

inline LobeNumbers lobeNumbers(const Sampler& random) {
    return {random.get2D(Purpose::kDirection), random.get1D(Purpose::kWay)};
}

// By one lobe, chosen in proportion to what it would carry.
inline bool sampleLobe(const Bsdf& bsdf, const Sampler& random, BsdfSample& sample) {
    return bsdf.sample(random.get1D(Purpose::kLobe), random.get2D(Purpose::kDirection), sample);
}

// A surface, not black, that a camera path has met.
struct PathStop {
    const Ray& ray;  // that led there
    const Surface& surface;
    const Bsdf& bsdf;
    const Rgb& throughput;          // of the path up to here
    const RayFootprint& footprint;  // at the surface
    Lobe next;                      // by which the path would leave
    const Sampler& sampler;         // of the path, at this event

    // Whether indirect light is gathered here: at the first diffuse surface, and where a broad lobe
    // leads on, along which gather rays look for it.
    bool isGathered() const { return bsdf.has(Lobe::kDiffuse) && !goesOn(); }
    // Whether it may be farther on.
    bool goesOn() const { return next != Lobe::kDiffuse && next != Lobe::kBroad; }
};

// The policy of pilots: each surface is visited, and the path goes on by one lobe.
template <typename Visit>
struct VisitingPath {
    using Step = CameraStep;
    static constexpr Transport kTransport = Transport::kRadiance;

    const Visit& visit;

    static CacheUser user(const Step& step) { return step.user(); }
    static void setOut(const Step&) {}
    static void meetNothing(const Step&) {}
    static Verdict meet(const Step&, const Surface&) { return Verdict::kScatter; }
    bool scatter(Step& step, const Surface& surface, const Bsdf& bsdf, Waiting<Step>&) const {
        if (bsdf.isBlackBody()) return false;
        BsdfSample sample;
        const bool goesOn = sampleLobe(bsdf, step.random, sample);
        return visit(PathStop{step.ray, surface, bsdf, step.carried, step.footprint, sample.lobe,
                              step.random}) &&
               goesOn && step.scatter(surface, bsdf, sample);
    }
};

// Follows a path from the camera until visit(PathStop) returns false, or it ends as one of any kind
// would. footprint: of the first ray.
template <typename Visit>
void followCameraPath(const Scene& scene, const Ray& first, const RayFootprint& footprint,
                      const Sampler& sampler, const Visit& visit) {
    walk(scene, VisitingPath<Visit>{visit}, CameraStep(first, footprint, sampler));
}

}  // namespace pm
