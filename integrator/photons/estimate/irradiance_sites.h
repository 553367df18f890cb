// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <optional>

#include "integrator/photons/estimate/surface_cells.h"
#include "integrator/photons/estimate/surface_estimate.h"
#include "integrator/photons/map/big_array.h"
#include "integrator/photons/map/photon_map.h"
#include "integrator/scene/scene.h"

namespace pm {

// Irradiance of a photon map, kept at points on the surfaces (sites): what final gathering looks
// up. One site in each of the SurfaceCells, of about half a radius, so on dark surfaces too. Its
// value is computed when it is first asked for.
// Source: Christensen 1999, "Faster Photon Map Global Illumination" (irradiance kept at points).
// Threads: const functions from any, at once.
class IrradianceSites {
  public:
    // scene, map and patches must outlive this. radius: of the estimates, scene units, > 0.
    // patches: see SurfaceEstimate. radiusFactor: this pass's radii over the first pass's, by which
    // room is made for more sites, in (0, 1]. focus: where the radius is as given; beyond it
    // estimates are wider. room: the share of the usual room for sites, in (0, 1]; what is not kept
    // is estimated again when it is asked for, to the same bits. key: of the seed and the pass,
    // says where the sites are.
    IrradianceSites(const Scene& scene, const PhotonMap& map, float radius,
                    const SurfacePatches* patches = nullptr, float radiusFactor = 1.0f,
                    const Focus& focus = {}, float room = 1.0f, std::uint64_t key = 0);

    // Irradiance, W m^-2, at a site near the point, on the side of the normal, that the point is
    // seen from; estimated at the point itself where none is.
    TwoRadii at(const Vec3f& position, const Vec3f& normal) const;
    // Alike for places that ask for the same site first.
    std::uint64_t siteOf(const Vec3f& position, const Vec3f& normal) const {
        return m_cells.at(position, normal).hash();
    }
    // Asks for the site to be at hand soon.
    void prefetch(const Vec3f& position, const Vec3f& normal) const {
        __builtin_prefetch(&m_slots[firstSlot(siteOf(position, normal))]);
    }

    // Computes those where photons landed, in the map's order, so that a map in pages is read about
    // once, page after page; to the same bits as when they are asked for. In parallel in the
    // calling TBB arena. Throws Error(kCancelled) soon after cancel is set.
    void fill(const CancelCheck& cancel) const;

    // Irradiance, W m^-2, at a point, computed now. pattern turns the rays about the normal.
    TwoRadii estimate(const Vec3f& position, const Vec3f& normal, std::uint32_t pattern) const {
        return estimateOf(m_cells.focus().levelAt(position)).at(position, normal, pattern);
    }

    std::uint64_t memoryBytes() const;
    // The same of a map of so many photons.
    static std::uint64_t memoryBytes(std::uint64_t photons, float radiusFactor = 1.0f,
                                     float room = 1.0f);

  private:
    using Cell = SurfaceCells::Cell;
    // A point of a surface; the normal is 0 where a cell has none.
    struct Place {
        Vec3f position, normal;
    };
    struct Value {
        TwoRadii irradiance;
        float height = 0.0f;  // above the site, from where places look like its own; scene units
    };
    // What is known of a site: many are asked for by places that they don't speak for, and then
    // their irradiance is never needed.
    enum Known : std::uint32_t { kNothing, kPlace, kAll };
    // Atomic, as two threads may come here at once: they compute and store the same bits.
    struct alignas(64) Slot {
        std::atomic<std::uint64_t> cell;
        std::array<std::atomic<float>, 6> place;
        std::array<std::atomic<float>, 7> value;
        std::atomic<std::uint32_t> known;
    };

    std::size_t firstSlot(std::uint64_t hash) const {
        return static_cast<std::size_t>((static_cast<unsigned __int128>(hash) * m_slotCount) >> 64);
    }
    SurfaceEstimate estimateOf(int level) const {
        return m_estimate.withRadius(m_estimate.radius() * powerOfTwo(level));
    }
    Slot* slotOf(std::uint64_t hash) const;
    Place placeOf(const Cell& cell, Slot* slot) const;
    Value valueOf(const Cell& cell, std::uint64_t hash, const Place& site, Slot* slot) const;
    bool isBeside(const Place& site, const Cell& cell, const Vec3f& position,
                  const Vec3f& normal) const;
    std::optional<TwoRadii> ask(const Cell& cell, const Vec3f& position, const Vec3f& normal) const;
    Cell nearestAside(const Cell& cell, const Vec3f& position, const Vec3f& normal) const;

    SurfaceEstimate m_estimate;
    SurfaceCells m_cells;
    // Open addressing by the cell's hash; all zero where nobody has asked yet. Slots are asked for
    // in no order: hence large pages.
    std::size_t m_slotCount;
    BigArray<Slot> m_slots;
};

}  // namespace pm
