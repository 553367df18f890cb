// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>
#include <cstdint>

#include "integrator/light_sampling/light_sampler.h"
#include "integrator/photons/estimate/caustic_map.h"
#include "integrator/photons/estimate/irradiance_sites.h"
#include "integrator/photons/estimate/received_map.h"
#include "integrator/sampling/sampler.h"
#include "integrator/scene/camera.h"
#include "integrator/scene/scene.h"
#include "integrator/transport/gather/gather_points.h"
#include "integrator/transport/path/direct_light.h"
#include "integrator/transport/path/path_walk.h"

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
    SampleRadiance sample(const View& view, Sampler& sampler, NearestPhotons& scratch) const;

  private:
    // Which part of a diffuse reflection a ray along the lobe still has to find.
    struct StillToFind {
        LampStrategy lamps = LampStrategy::kBoth;
        bool indirect = false;
        std::uint32_t ownRays = 1;  // by how many rays along it
        float width = 0.0f;         // of the footprint that they start from, scene units

        bool any() const { return indirect || lamps == LampStrategy::kBoth; }
    };
    // A camera path on its way.
    struct Branch {
        PathWalk path;
        PathState state;
        LastScatter last;
        std::uint32_t lampSamples = 1;
        float way = 0.0f;  // that it has come, scene units
        // Of what the camera sample brings, this branch's part, were all that it meets as bright:
        // what is worth how much work.
        float share = 1.0f;

        bool goOn(const Surface& surface, const Bsdf& bsdf, const BsdfSample& sample, bool isPart,
                  Sampler& sampler);
    };
    // What all branches of one sample share.
    struct Tree {
        const View& view;
        Sampler& sampler;
        NearestPhotons& scratch;
        SampleRadiance& result;
    };
    // Of each lobe, with which probability the path was to be followed along it; 0: it is not.
    using Survival = std::array<float, kLobeCount>;
    // diffuse: whether that lobe is one to follow.
    static Survival divide(const Bsdf& bsdf, const Carried& path, bool diffuse, Sampler& sampler);
    void addLampsAlong(Branch& branch, const Tree& tree) const;
    // To its end.
    void follow(Branch& branch, const Tree& tree) const;
    // Along all lobes but one, which `branch` then is on. False: there is none.
    bool followLobes(const Surface& surface, const Bsdf& bsdf, StillToFind still, Branch& branch,
                     const Tree& tree) const;
    StillToFind addReflected(const Surface& surface, const Bsdf& bsdf, const Branch& branch,
                             const Tree& tree) const;
    StillToFind readMaps(const Surface& surface, const Bsdf& bsdf, const Branch& branch,
                         const Tree& tree) const;
    void addReceived(const Surface& surface, const Bsdf& bsdf, const Branch& branch,
                     const Tree& tree) const;
    // Whether a map has the light that a path in this state finds at a lamp.
    bool isOfMap(const PathState& state) const { return m_maps.received && state.isCausticOnWide; }
    void addRefocused(const GatherPoints::Place& place, float clearance, float share,
                      const Rgb& reflected, const Tree& tree) const;
    void followDiffuse(const Surface& surface, const Bsdf& bsdf, const Branch& branch,
                       StillToFind still, float survival, const Tree& tree) const;
    void followBroad(const Surface& surface, const Bsdf& bsdf, const Branch& branch, float survival,
                     const Tree& tree) const;
    void gatherAlong(const Ray& ray, const LastScatter& last, StillToFind still, const Rgb& weight,
                     std::uint32_t rays, float cosine, Sampler& sampler,
                     SampleRadiance& result) const;
    void sampleCaustics(const Surface& surface, const Bsdf& bsdf, const Rgb& throughput,
                        std::uint32_t rays, Sampler sampler, SampleRadiance& result) const;

    const Scene& m_scene;
    const LightSampler& m_lights;
    PhotonMaps m_maps;
    std::uint32_t m_lampSamples;
};

}  // namespace pm
