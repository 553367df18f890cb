// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>
#include <cstdint>

#include "integrator/photons/emission/focus.h"
#include "integrator/scene/scene.h"

namespace pm {

// Space in cells, and the surfaces in them: the surfaces of about one direction in a cell are found
// where a ray along that direction meets them, from the cell's middle if it can be. So what is
// found depends on the cell alone, never on who asks first, and is spread evenly over all surfaces.
// Threads: const functions from any, at once.
class SurfaceCells {
  public:
    // scene must outlive this. cellSize: in focus, scene units, > 0; origin: a corner of one of the
    // cells.
    SurfaceCells(const Scene& scene, float cellSize, const Vec3f& origin, const Focus& focus = {})
        : m_scene(scene), m_cellSize(cellSize), m_origin(origin), m_focus(focus) {}

    // A cell and a rough direction.
    struct Cell {
        std::array<std::int64_t, 3> place;
        std::array<std::int64_t, 3> direction;
        int level = 0;     // of the focus, by which cells differ in size
        int halvings = 0;  // of that size

        std::uint64_t hash() const;  // never 0
    };

    // normal: unit. halvings: how often the cell is to be halved, >= 0.
    Cell at(const Vec3f& position, const Vec3f& normal, int halvings = 0) const;
    // A point of diffuse surface and its geometric normal on the side of the cell's direction;
    // false where there is none.
    bool findSurface(const Cell& cell, Vec3f& position, Vec3f& normal) const;

    // Of a side, scene units.
    float sizeOf(const Cell& cell) const { return sizeOf(cell.level, cell.halvings); }
    const Focus& focus() const { return m_focus; }
    const Vec3f& origin() const { return m_origin; }

  private:
    float sizeOf(int level, int halvings) const {
        return m_cellSize * powerOfTwo(level - halvings);
    }
    bool findAlong(const Vec3f& middle, const Vec3f& through, const Vec3f& direction,
                   float cellSize, Vec3f& position, Vec3f& normal) const;

    const Scene& m_scene;
    float m_cellSize;
    Vec3f m_origin;
    Focus m_focus;
};

}  // namespace pm
