// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>
#include <memory>

#include "integrator/photons/estimate/surface_patch.h"
#include "integrator/scene/scene.h"

namespace pm {

// The patches of a scene's surfaces, for discs of any radius: one in each of the SurfaceCells, for
// radii in steps of 2. A patch is made when first asked for, depends on cell and step alone, and is
// kept for later passes.
// Threads: at() from any, at once.
class SurfacePatches {
  public:
    static constexpr std::uint64_t kMostBytes = std::uint64_t{32} << 20;

    // scene must outlive this. unit: a radius to count the steps from, scene units, > 0. mostBytes:
    // of memory for patches; those that have no room are made each time they are asked for.
    SurfacePatches(const Scene& scene, float unit, std::uint64_t mostBytes = kMostBytes);
    ~SurfacePatches();

    const Scene& scene() const { return m_scene; }
    // The patch for a disc around a point; see whether it speaks for it. spare: holds it where
    // there is no room to keep it.
    const SurfacePatch& at(const Vec3f& position, const Vec3f& normal, float radius,
                           SurfacePatch& spare) const;
    // Where room has run out, forgets what earlier passes asked for; while nobody else is here.
    void makeRoom();

    std::uint64_t memoryBytes() const;

  private:
    struct Table;

    const Scene& m_scene;
    float m_unit;
    std::uint64_t m_mostBytes;
    std::unique_ptr<Table> m_table;
};

}  // namespace pm
