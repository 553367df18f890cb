// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>

#include "integrator/photons/photon_map.h"
#include "integrator/scene/scene.h"

namespace pm {

// Irradiance of a photon map at a point of a surface.
//
// Near an edge a part of the estimate's disc is not on the surface. It is found by short rays from
// above the point, and the flux is divided by the area that is there; there, too, only photons that
// are seen from above the point count, so that none is counted across a wall.
// Threads: const functions from any, at once.
class SurfaceEstimate {
  public:
    // scene and map must outlive this. radius: scene units, > 0.
    SurfaceEstimate(const Scene& scene, const PhotonMap& map, float radius)
        : m_scene(scene), m_map(map), m_radius(radius) {}

    float radius() const { return m_radius; }
    // The same at another radius.
    SurfaceEstimate withRadius(float radius) const { return {m_scene, m_map, radius}; }

    // W m^-2, on the side of the normal. pattern turns the rays about the normal.
    TwoRadii at(const Vec3f& position, const Vec3f& normal, std::uint32_t pattern) const;

  private:
    // Share of the disc that is surface.
    struct Shares {
        float wide = 1.0f, narrow = 1.0f;
    };
    // A piece of surface: its area for each unit of the disc's plane; 0 where there is none whose
    // photons the map would count, 1 where the surface is the plane.
    struct Seen {
        float area = 0.0f, distanceSquared = 0.0f;
    };
    // The point, what is above it, and how the rays are turned.
    struct View {
        Vec3f position, normal, apex;
        Vec3f tangent, bitangent;
        float turn, shift;  // [0, 1)
    };
    float apexHeight(const Vec3f& position, const Vec3f& normal) const;
    Seen look(const View& view, float turns, float radiusSquared) const;
    bool isWhole(const View& view) const;
    Shares shares(const View& view) const;

    const Scene& m_scene;
    const PhotonMap& m_map;
    float m_radius;
};

}  // namespace pm
