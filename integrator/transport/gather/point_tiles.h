// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "integrator/values/rect.h"

namespace pm {

// The lattice of gather points over a frame, in tiles: what is made when a sample first asks for a
// point of it, and may be forgotten when all pixels whose samples could ask are done. A plain
// value.
class PointTiles {
  public:
    static constexpr std::int32_t kSide = 16;  // of a tile, cells
    static constexpr std::size_t kCells = std::size_t{kSide} * kSide;
    // Cells beyond each side of the frame that hold points too: for samples at the frame's edge and
    // those up to 3 pixels beyond, of a group of pixels with a wide filter.
    static constexpr std::int32_t kMargin = 3;

    // width, height: pixels of the frame. spacing: of the lattice, pixels. radius: the largest
    // within which samples ask for points, pixels.
    PointTiles(std::int32_t width, std::int32_t height, float spacing, float radius);

    std::int32_t columns() const { return m_columns; }  // cells
    std::int32_t rows() const { return m_rows; }
    std::int32_t across() const { return (m_columns + kSide - 1) / kSide; }  // tiles
    std::int32_t down() const { return (m_rows + kSide - 1) / kSide; }
    std::size_t count() const {
        return static_cast<std::size_t>(across()) * static_cast<std::size_t>(down());
    }

    // The pixels whose samples may ask for points of a tile (row * across() + column).
    Rect reach(std::size_t tile) const;
    // The tiles that pixels of the region may ask, in tiles: columns by rows.
    Rect asked(const Rect& region) const;

    // The most tiles that are there at a time, when the regions, which divide `all`, are done one
    // after the other, `atOnce` of them side by side, and each tile is forgotten when it may be.
    // Some more where that is not known.
    std::size_t mostAtOnce(std::span<const Rect> regions, const Rect& all,
                           std::size_t atOnce) const;

  private:
    std::int32_t m_columns, m_rows;
    double m_tilePixels, m_marginPixels, m_reachPixels;
};

}  // namespace pm
