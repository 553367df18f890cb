// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>
#include <cstdint>
#include <memory>

#include "integrator/photons/map/photon_map.h"
#include "integrator/scene/scene.h"

namespace pm {

// The surface around a site, for density estimates whose discs lie about it: which share of a disc
// is surface that is seen from above the site, and which photons are on that surface. Learnt by
// short rays, once, and kept as areas on a grid in the site's plane.
// Threads: const functions from any, at once.
class SurfacePatch {
  public:
    // Share of a disc and of the one of half its area.
    struct Shares {
        float wide = 1.0f, narrow = 1.0f;
    };

    // Speaks for no point.
    SurfacePatch() = default;
    // position, normal: of the site. radius: the largest of the discs, scene units, > 0; what is
    // farther than kHalfWidth radii from the site along an axis of its plane is left out.
    // pattern: chooses the rays.
    SurfacePatch(const Scene& scene, const Vec3f& position, const Vec3f& normal, float radius,
                 std::uint64_t pattern);
    static constexpr float kHalfWidth = 1.75f;

    // Whether what is known here holds for a disc around this point: it is on the site's surface
    // and seen from above the site, and the surface is whole, or nearly flat and most of the disc
    // on the grid. radius: scene units.
    bool speaksFor(const Scene& scene, const Vec3f& position, const Vec3f& normal,
                   float radius) const;
    // No edge, fold or obstacle within reach: all discs are whole, all photons count.
    bool isWhole() const { return !m_grid; }
    // Photons may lie where surface is not seen, beyond a wall or under a ball: see counts().
    // In scenes with sheets under one, too, wherever all is not one plane.
    bool hidesSurface() const {
        return m_isAmongSheets ? !m_isBesideSheets : m_grid && m_grid->hasHidden;
    }
    // Of a disc around a point that this speaks for; at least kSmallestShare. radius: scene units.
    Shares shares(const Vec3f& position, float radius) const;
    // Whether a photon, within a disc around a point that this speaks for, is to be counted.
    bool counts(const Scene& scene, const Photon& photon) const;
    // The flux of those of a map's photons that count, W, at a radius and at that over sqrt(2), of
    // a disc around a point that this speaks for. all: PhotonMap::fluxWithin there. radius: scene
    // units.
    TwoRadii countedFlux(const Scene& scene, const PhotonMap& map, const Vec3f& position,
                         const Vec3f& normal, float radius, const TwoRadii& all) const;

    std::uint64_t memoryBytes() const { return sizeof(*this) + (m_grid ? sizeof(Grid) : 0); }

  private:
    // Squares along a side.
    static constexpr std::int32_t kSquares = 16;
    static constexpr float kSquaresPerRadius = kSquares / (2.0f * kHalfWidth);
    static constexpr float kMiddle = 0.5f * kSquares;
    struct Grid {
        Vec3f tangent, bitangent;
        bool hasHidden = false;
        // Of each row, the area seen up to a column; 1 is a square.
        std::array<std::array<float, kSquares + 1>, kSquares> areaUpTo;
        // Bit x of row y: this square and those around it are all seen; no edge is near.
        std::array<std::uint32_t, kSquares> isInner{};
    };
    // A place on the grid, in squares.
    struct Place {
        float x, y;

        bool isInside() const;
    };
    enum class Seen { kNothing, kFlat, kBent };
    class Survey;

    Vec3f inPlane(Place place) const;
    Place placeOf(const Vec3f& position) const;
    Seen look(const Scene& scene, const PhotonGate& gate, Place towards) const;
    // Whether the surface bends evenly from the site to a place, on a way from the site.
    bool bendsEvenly(const Vec3f& way, const Vec3f& normal, float within) const;
    bool looksWhole(const Scene& scene, const PhotonGate& gate);
    bool measure(const Scene& scene, const PhotonGate& gate, std::uint64_t pattern);
    bool hides(const Scene& scene, const PhotonGate& gate, Place place) const;
    bool isInner(Place place) const;
    float share(Place middle, float radius) const;
    bool sees(const Scene& scene, const Vec3f& position, const Vec3f& normal) const;

    Vec3f m_position, m_normal, m_apex;  // the normal is 0 where this speaks for no point
    float m_radius = 0.0f, m_height = 0.0f;
    // Of a scene with sheets; and whole there, in one plane, where another sheet may lie closer
    // than that tells of: photons count that lie in the plane.
    bool m_isAmongSheets = false, m_isBesideSheets = false;
    std::unique_ptr<Grid> m_grid;
};

}  // namespace pm
