// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "integrator/materials/bsdf.h"
#include "integrator/photons/estimate/irradiance_sites.h"
#include "integrator/photons/map/photon_map.h"
#include "integrator/scene/scene.h"
#include "integrator/values/cancel_check.h"

namespace pm {

// Caustics as lamps: the light that diffuse surfaces, lit by way of mirrors and glass, send
// straight to others. It is found in two ways, weighted by the balance heuristic: by gather rays,
// which read the caustics' irradiance where they end; and by rays to some of the caustic photons,
// each a point that reflects its flux. Gather rays seldom meet a small bright spot, the second way
// knows where it is; beside a wide one the nearest points would be specks, gather rays see all of
// it.
//
// How dense photons lie is taken from the irradiance that the gather rays read, so the two weights
// of a place sum to 1 whatever the noise in it.
// Source: Keller 1997, "Instant Radiosity"; Veach 1997, section 9.2 (the balance heuristic).
// Threads: const functions from any, at once.
class VirtualLamps {
  public:
    // Where light is wanted.
    struct Place {
        Vec3f position;
        Vec3f start;                           // rays leave from here, off the surface
        Vec3f shadingNormal, geometricNormal;  // unit, on the side that light comes to
        Admission admission{};                 // of the surface there
    };

    // caustics: photons of diffuse surfaces reached by way of other lobes. They, scene and patches
    // must outlive this. radius, patches, radiusFactor, room: see IrradianceSites. random: chooses
    // among the photons. Works in parallel in the calling TBB arena. Throws Error(kCancelled) soon
    // after cancel is set.
    VirtualLamps(const Scene& scene, const PhotonMap& caustics, float radius,
                 const SurfacePatches* patches, float radiusFactor, std::uint64_t random,
                 const CancelCheck& cancel = {}, float room = 1.0f);

    // Rays to lamps beside so many gather rays.
    static std::uint32_t raysBeside(std::uint32_t gatherRays) {
        return std::max(1u, gatherRays / 2);
    }

    // Of the caustics' irradiance where a gather ray ends, W m^-2, the part that such rays count.
    // density: of gather rays by the cosine, all together 1, for each unit of area there, scene
    // units^-2.
    TwoRadii gathered(const Vec3f& position, const Vec3f& normal, float density,
                      std::uint32_t gatherRays) const;
    // All of it, for what is found in no other way.
    TwoRadii kept(const Vec3f& position, const Vec3f& normal) const {
        return m_lamps.empty() ? TwoRadii{} : m_sites.at(position, normal);
    }
    // The rest of the irradiance at a place, W m^-2, by raysBeside(gatherRays) rays. u: in [0, 1):
    // which lamps; spread it evenly over places near each other.
    Rgb sampled(const Place& place, std::uint32_t gatherRays, float u) const;

    // As IrradianceSites::fill, of what gathered() and kept() read.
    void fill(const CancelCheck& cancel) const { m_sites.fill(cancel); }
    // Asks for what gathered() reads to be at hand soon.
    void prefetch(const Vec3f& position, const Vec3f& normal) const {
        m_sites.prefetch(position, normal);
    }
    std::uint64_t memoryBytes() const;
    // The same of so many caustic photons.
    static std::uint64_t memoryBytes(std::uint64_t photons, float radiusFactor = 1.0f,
                                     float room = 1.0f);

  private:
    // A photon, its flux that of all of them; density: of lamps there, all of them together 1,
    // scene units^-2.
    struct Lamp {
        Vec3f position, normal;
        Rgb flux;
        float density = 0.0f;
    };
    void findDensities(const CancelCheck& cancel);
    Rgb irradianceBy(const Lamp& lamp, const Place& place, std::uint32_t gatherRays) const;
    bool reach(const Ray& ray, const Vec3f& place, float tolerance, Surface& met, Rgb& share) const;
    float densityOf(const Rgb& irradiance) const {
        return static_cast<float>(channelSum(irradiance)) * m_inverseFlux;
    }

    const Scene& m_scene;
    IrradianceSites m_sites;
    std::vector<Lamp> m_lamps;
    float m_inverseFlux = 0.0f;  // of all photons, summed over the channels, W^-1
};

}  // namespace pm
