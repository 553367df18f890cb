// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "host_shim/formats/scene_data.h"

namespace pm::host {

// Turns a place or direction of a scene whose z is up to where y is, and back.
std::array<double, 3> asIfYWereUp(const std::array<double, 3>& place);
std::array<double, 3> backToZUp(const std::array<double, 3>& place);
Bounds asIfYWereUp(const Bounds& bounds);

// A cell of an OccupancyGrid.
using Cell = std::array<int, 3>;

// Which cells of a coarse regular grid over a scene's bounds hold surface: for choosing where to
// look from. What light passes straight or bent (glass, cut-outs) holds nothing. Costs some
// nanoseconds a small face and at most a fixed time for large ones; the same for the same scene.
// Immutable.
class OccupancyGrid {
  public:
    static constexpr int kCells = 64;  // along the longest side of the bounds
    static constexpr int kMargin = 1;  // empty cells beside the bounds
    // -x, +x, -y, +y, -z, +z.
    static constexpr std::size_t kSides = 6;

    // upIsZ: the scene is turned before, by asIfYWereUp.
    explicit OccupancyGrid(const SceneData& scene, bool upIsZ = false);

    const Cell& size() const { return m_size; }
    double cellSize() const { return m_cellSize; }  // scene units; 0 for a scene without extent
    std::size_t count() const { return m_holds.size(); }
    bool contains(const Cell& cell) const;
    std::size_t indexOf(const Cell& cell) const {
        return (static_cast<std::size_t>(cell[2]) * static_cast<std::size_t>(m_size[1]) +
                static_cast<std::size_t>(cell[1])) *
                   static_cast<std::size_t>(m_size[0]) +
               static_cast<std::size_t>(cell[0]);
    }
    Cell cellOf(const std::array<double, 3>& place) const;  // may lie outside
    std::array<double, 3> middleOf(const Cell& cell) const;

    bool holds(const Cell& cell) const { return m_holds[indexOf(cell)] == kSurface; }
    // Whether anything is in it, be it glass or a cut-out.
    bool reaches(const Cell& cell) const { return m_holds[indexOf(cell)] != 0; }
    // Area of the surface in a cell, as it is seen from a side; of lamps alone the second.
    float areaSeenFrom(std::size_t side, const Cell& cell) const {
        return m_areas[indexOf(cell)][side];
    }
    struct Lamp {
        Cell cell{};
        std::array<float, kSides> areas{};
    };
    const std::vector<Lamp>& lamps() const { return m_lamps; }

  private:
    static constexpr std::uint8_t kClear = 1, kSurface = 2;
    struct Splat;
    void add(const InstanceData& instance, const SceneData& scene, std::int64_t& budget);
    void splat(const Splat& triangle, std::int64_t& budget);

    bool m_upIsZ{};
    std::array<double, 3> m_origin{};
    double m_cellSize{};
    Cell m_size{1, 1, 1};
    std::vector<std::uint8_t> m_holds;
    std::vector<std::array<float, kSides>> m_areas;
    std::vector<Lamp> m_lamps;
};

}  // namespace pm::host
