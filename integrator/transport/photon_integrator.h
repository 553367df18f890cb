// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>
#include <optional>

#include "integrator/photons/caustic_map.h"
#include "integrator/photons/irradiance_sites.h"
#include "integrator/sampling/sampler.h"
#include "integrator/scene/light_sampler.h"
#include "integrator/scene/scene.h"
#include "integrator/transport/direct_light.h"
#include "integrator/transport/gather_points.h"
#include "integrator/transport/path_walk.h"

namespace pm {

// The maps of one pass; null where the plan has none.
struct PhotonMaps {
    const IrradianceSites* global = nullptr;
    const GatherPoints* points = nullptr;  // refers to global, refocused and lamps
    const SurfaceEstimate* refocused = nullptr;
    const CausticMap* caustic = nullptr;
    const VirtualLamps* lamps = nullptr;
};

// Radiance from photon maps. Every light path belongs to one class, every class to one estimator
// (see PathClass): direct light to next-event estimation, weighted against a ray along the diffuse
// lobe where lamps fill much of the view; caustics to the density estimate of their map at the
// first diffuse surface; indirect light to the gather points near it, or to a gather ray of its own
// where there are none. Other lobes are followed until a diffuse one.
// Source: Jensen 2001, chapter 9 (the partition).
// Threads: any, at once, each with a scratch of its own.
class PhotonIntegrator {
  public:
    // lampSamples: of next-event estimation where a camera sample first meets a lobe that is not
    // delta, a power of two; farther on there is one.
    PhotonIntegrator(const Scene& scene, const LightSampler& lights, const PhotonMaps& maps,
                     std::uint32_t lampSamples = 1)
        : m_scene(scene), m_lights(lights), m_maps(maps), m_lampSamples(lampSamples) {}

    // screen: where the ray leaves the camera, pixels. withSeenLamps: false where emission is left
    // to paths of SeenLamps.
    SampleRadiance sample(Vec2f screen, const Ray& ray, Sampler& sampler, NearestPhotons& scratch,
                          bool withSeenLamps = true) const;

  private:
    // Which part of a diffuse reflection a ray along the lobe still has to find.
    struct StillToFind {
        LampStrategy lamps = LampStrategy::kBoth;
        bool indirect = false;
    };
    // A camera path on its way.
    struct Branch {
        PathWalk path;
        PathState state;
        LastScatter last;
        std::uint32_t lampSamples = 1;

        bool goOn(const Surface& surface, const Bsdf& bsdf, const BsdfSample& sample,
                  Sampler& sampler);
    };
    // Where glass is met: the reflected part goes on by itself, the path by `refraction`. False
    // where there are other lobes, or too little in one of the two.
    static bool divide(const Surface& surface, const Bsdf& bsdf, const Branch& branch,
                       std::optional<Branch>& reflected, BsdfSample& refraction, Sampler& sampler);
    // To its end; `reflected` gets what the first glass reflects, null: it is not divided.
    void follow(Vec2f screen, Branch& branch, std::optional<Branch>* reflected, Sampler& sampler,
                NearestPhotons& scratch, bool withSeenLamps, SampleRadiance& result) const;
    StillToFind addReflected(Vec2f screen, const Surface& surface, const Bsdf& bsdf,
                             const Branch& branch, Sampler& sampler, NearestPhotons& scratch,
                             SampleRadiance& result) const;
    StillToFind readMaps(Vec2f screen, const Surface& surface, const Bsdf& bsdf,
                         const Rgb& throughput, NearestPhotons& scratch,
                         SampleRadiance& result) const;
    void followDiffuse(const Surface& surface, const Bsdf& bsdf, const Branch& branch,
                       StillToFind still, float uLobe, const Sampler& directions,
                       SampleRadiance& result) const;
    void gatherAlong(const LastScatter& last, StillToFind still, const Rgb& weight,
                     std::uint32_t rays, float cosine, Sampler& sampler,
                     SampleRadiance& result) const;
    void sampleCaustics(const Surface& surface, const Bsdf& bsdf, const Rgb& throughput,
                        Sampler sampler, SampleRadiance& result) const;

    const Scene& m_scene;
    const LightSampler& m_lights;
    PhotonMaps m_maps;
    std::uint32_t m_lampSamples;
};

}  // namespace pm
