// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <vector>

#include "integrator/photons/photon_map.h"
#include "integrator/scene/scene.h"

namespace pm {

// Irradiance of a photon map, kept at points on the surfaces (sites) and read at the nearest one:
// what final gathering looks up. A site's value is computed when it is first asked for; it does not
// depend on who asks. Sites are places where other photons than the map's landed, so that they are
// dense where there is light, and independent of the photons that they count.
//
// Near an edge a part of the estimate's disc is not on the surface. It is found by short rays from
// above the site, and the flux is divided by the area that is there; there, too, only photons that
// are seen from above the site count, so that none is counted across a wall.
// Source: Christensen 1999, "Faster Photon Map Global Illumination" (irradiance kept at photons).
// Threads: const functions from any, at once.
class IrradianceSites {
  public:
    // scene and map must outlive this. radius: of the estimates, scene units, > 0.
    IrradianceSites(const Scene& scene, const PhotonMap& map, std::vector<Photon> sites,
                    float radius);

    // Irradiance, W m^-2, at the site nearest to the point on the side of the normal; estimated at
    // the point itself where no site is near.
    Rgb at(const Vec3f& position, const Vec3f& normal, NearestPhotons& scratch) const;

    // Irradiance at a point, computed now. pattern turns the rays about the normal.
    Rgb estimate(const Vec3f& position, const Vec3f& normal, std::uint32_t pattern) const;

    std::uint64_t memoryBytes() const;

  private:
    struct Kept {
        std::atomic<float> r{0}, g{0}, b{0};
        std::atomic<std::uint32_t> ready{0};
    };
    float apexHeight(const Vec3f& position, const Vec3f& normal) const;
    float areaSeen(const Vec3f& position, const Vec3f& normal, float apexHeight,
                   const Vec3f& inPlane) const;
    float surfaceShare(const Vec3f& position, const Vec3f& normal, float apexHeight,
                       std::uint32_t pattern) const;

    const Scene& m_scene;
    const PhotonMap& m_map;
    PhotonMap m_sites;
    std::unique_ptr<Kept[]> m_kept;
    float m_radius;
};

}  // namespace pm
