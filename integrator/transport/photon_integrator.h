// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include "integrator/photons/caustic_map.h"
#include "integrator/photons/irradiance_sites.h"
#include "integrator/rays/ray_tracer.h"
#include "integrator/sampling/sampler.h"
#include "integrator/scene/light_sampler.h"
#include "integrator/scene/scene.h"
#include "integrator/transport/direct_light.h"

namespace pm {

// The maps of one pass; null where the plan has none.
struct PhotonMaps {
    const IrradianceSites* global = nullptr;
    const CausticMap* caustic = nullptr;
};

// Radiance from photon maps: direct light by next-event estimation and by the gather rays that meet
// a light, caustics from their map at the first diffuse surface, indirect light by one final-gather
// ray a sample (or gatherRays) over the global map. Other lobes are followed until a diffuse one.
// Source: Jensen 2001, chapter 9; the partition is PathClass.
// Threads: any, at once, each with a scratch of its own.
class PhotonIntegrator {
  public:
    PhotonIntegrator(const Scene& scene, const LightSampler& lights, const PhotonMaps& maps,
                     std::uint32_t gatherRays)
        : m_scene(scene), m_lights(lights), m_maps(maps), m_gatherRays(gatherRays) {}

    SampleRadiance sample(Ray ray, Sampler& sampler, NearestPhotons& scratch) const;

  private:
    void gather(const Surface& from, const BsdfSample& first, const Rgb& weight, Sampler& sampler,
                NearestPhotons& scratch, SampleRadiance& result) const;

    const Scene& m_scene;
    const LightSampler& m_lights;
    PhotonMaps m_maps;
    std::uint32_t m_gatherRays;
};

}  // namespace pm
