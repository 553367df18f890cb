// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>
#include <optional>

#include "integrator/photons/map/photon_map.h"
#include "integrator/scene/scene.h"

namespace pm {

class SurfacePatches;

// The share of the disc in the sharpest corner that is still told apart; a square one has 1/4.
inline constexpr float kSmallestShare = 0.1f;

// A piece of surface: its area for each unit of the plane through a point; 0 where there is none
// whose photons count for the point, 1 where the surface is the plane.
struct SeenArea {
    float area = 0.0f;
    Vec3f fromPoint, normal;  // the normal on the apex's side
};
// What is seen from the apex, above the gate's point, towards a place of the point's plane.
// ofGlossy: of surfaces with a glossy lobe, in place of those that reflect diffusely.
SeenArea lookFor(const Scene& scene, const PhotonGate& gate, const Vec3f& apex,
                 const Vec3f& inPlane, bool ofGlossy = false);
// How far above a point to look from, scene units: enough to see a disc of this radius, but half as
// high as whatever stands there; under a ball on the floor the apex must not be inside the ball.
float apexHeight(const Scene& scene, const Vec3f& position, const Vec3f& normal, float radius);
// Whether a point of a surface, lifted by Scene::liftOfPoints, is seen from the apex. For a hit
// that is pointUnderRay, so that a leaning wall is not passed on the way up.
bool isSeenFrom(const Scene& scene, const Vec3f& apex, const Vec3f& position, const Vec3f& normal);

// What photons of a map of glossy surfaces count for in place of their flux: what is reflected of
// them.
class PhotonWeights {
  public:
    explicit PhotonWeights(NearestPhotons& scratch) : scratch(scratch) {}
    virtual ~PhotonWeights() = default;
    PhotonWeights(const PhotonWeights&) = delete;
    PhotonWeights& operator=(const PhotonWeights&) = delete;
    // index: as PhotonMap::photon().
    virtual Rgb of(std::uint32_t index) const = 0;

    NearestPhotons& scratch;  // for queries
};

// A pattern of rays that depends on the place alone, to 1/256 of the estimate's radius: what
// rounding makes of a place does not change it.
std::uint32_t patternAt(const Vec3f& position, float radius);

// Irradiance of a photon map at a point of a surface.
//
// Near an edge a part of the estimate's disc is not on the surface. It is found by short rays from
// above the point, and the flux is divided by the area that is there; there, too, only photons that
// are seen from above the point count, so that none is counted across a wall. Where a patch knows
// the surface around the point it is asked in place of the rays. Where next to nothing of the disc
// is surface, a smaller one is taken.
// Threads: const functions from any, at once.
class SurfaceEstimate {
  public:
    // scene, map and patches must outlive this. radius: scene units, > 0. patches: of the scene;
    // null where rays are to be sent at every point.
    SurfaceEstimate(const Scene& scene, const PhotonMap& map, float radius,
                    const SurfacePatches* patches = nullptr)
        : m_scene(scene), m_map(map), m_radius(radius), m_patches(patches) {}
    SurfaceEstimate(const Scene& scene, const PhotonMap& map, float radius,
                    const PhotonWeights& weights)
        : m_scene(scene), m_map(map), m_radius(radius), m_patches(nullptr), m_weights(&weights) {}

    const Scene& scene() const { return m_scene; }
    const PhotonMap& map() const { return m_map; }
    float radius() const { return m_radius; }
    // Which photons count for a point, distance aside.
    PhotonGate gate(const Vec3f& position, const Vec3f& normal) const {
        return m_map.gate(position, normal);
    }
    // The same at another radius.
    SurfaceEstimate withRadius(float radius) const { return {m_scene, m_map, radius, m_patches}; }

    // W m^-2, on the side of the normal. pattern turns the rays about the normal.
    TwoRadii at(const Vec3f& position, const Vec3f& normal, std::uint32_t pattern) const;

  private:
    // Share of the disc that is surface.
    struct Shares {
        float wide = 1.0f, narrow = 1.0f;
    };
    // What a ray found: area as SeenArea has it, 0 beyond the radius.
    struct Seen {
        float area = 0.0f, distanceSquared = 0.0f;
    };
    // The point, what is above it, and how the rays are turned.
    struct View {
        Vec3f position, normal, apex;
        Vec3f tangent, bitangent;
        float turn, shift;  // [0, 1)
    };
    TwoRadii fluxWithin(const Vec3f& position, const Vec3f& normal, float radius) const;
    TwoRadii fluxSeen(const View& view) const;
    TwoRadii weighted(const Vec3f& position, const Vec3f& normal, float radius,
                      const Vec3f* apex) const;
    TwoRadii beside(const Vec3f& position, const Vec3f& normal, std::uint32_t pattern) const;
    std::optional<TwoRadii> ofWhatIsSeen(const Vec3f& position, const Vec3f& normal,
                                         std::uint32_t pattern, const TwoRadii& flux,
                                         int halvings) const;
    std::optional<Shares> askPatch(const Vec3f& position, const Vec3f& normal,
                                   TwoRadii& flux) const;
    Shares askRays(const Vec3f& position, const Vec3f& normal, std::uint32_t pattern, float least,
                   TwoRadii& flux) const;
    TwoRadii irradiance(const TwoRadii& flux, const Shares& share) const;
    SeenArea lookAt(const View& view, float turns, float radii) const;
    Seen look(const View& view, float turns, float radiusSquared) const;
    // isPlane: where it is, whether what tells so lies in the point's plane.
    bool isWhole(const View& view, bool& isPlane) const;
    Shares shares(const View& view) const;

    const Scene& m_scene;
    const PhotonMap& m_map;
    float m_radius;
    const SurfacePatches* m_patches;
    const PhotonWeights* m_weights = nullptr;
};

}  // namespace pm
