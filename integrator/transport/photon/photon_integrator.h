// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>

#include "integrator/light_sampling/light_sampler.h"
#include "integrator/photons/estimate/caustic_map.h"
#include "integrator/photons/estimate/irradiance_sites.h"
#include "integrator/photons/estimate/received_map.h"
#include "integrator/sampling/sampler.h"
#include "integrator/scene/camera.h"
#include "integrator/scene/scene.h"
#include "integrator/shapes/ray_footprint.h"
#include "integrator/transport/gather/gather_points.h"
#include "integrator/transport/path/direct_light.h"

namespace pm {

// The maps of one pass; null where the plan has none.
struct PhotonMaps {
    const IrradianceSites* global = nullptr;
    const GatherPoints* points = nullptr;  // refers to global, refocused and lamps
    const SurfaceEstimate* refocused = nullptr;
    const CausticMap* caustic = nullptr;
    const VirtualLamps* lamps = nullptr;
    const ReceivedMap* received = nullptr;
};

// Radiance from photon maps. Every light path belongs to one class, every class to one estimator
// (see PathClass): direct light to next-event estimation, weighted against a ray along the diffuse
// lobe where lamps fill much of the view; caustics to the density estimate of their map at the
// first diffuse surface; indirect light to the gather points near it, or to a gather ray of its own
// where there are none. Other lobes are followed until a diffuse one; by broad ones light is
// gathered as along the diffuse one. Source: Jensen 2001, chapter 9 (the partition). Threads: any,
// at once, each with a scratch of its own.
class PhotonIntegrator {
  public:
    // lampSamples: of next-event estimation where a camera sample first meets a lobe that is not
    // delta, a power of two; farther on there is one.
    PhotonIntegrator(const Scene& scene, const LightSampler& lights, const PhotonMaps& maps,
                     std::uint32_t lampSamples = 1)
        : m_scene(scene), m_lights(lights), m_maps(maps), m_lampSamples(lampSamples) {}

    // How a sample leaves the camera.
    struct View {
        Vec2f screen;  // where, pixels
        Ray ray;
        PixelBeam beam{};           // of no width where caustics may be narrower than any pixel
        bool withSeenLamps = true;  // false where emission is left to paths of SeenLamps
        RayFootprint footprint{};   // of the ray
    };
    // sampler: at the camera.
    SampleRadiance sample(const View& view, const Sampler& sampler, NearestPhotons& scratch) const;

  private:
    const Scene& m_scene;
    const LightSampler& m_lights;
    PhotonMaps m_maps;
    std::uint32_t m_lampSamples;
};

}  // namespace pm
