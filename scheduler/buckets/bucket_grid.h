// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>

#include "integrator/values/rect.h"

namespace pm {

// The frame is rendered in atoms of 8 x 8 pixels whose grid is anchored at pixel (0, 0) of the
// display window, never at a crop: rays that are batched together then don't depend on the crop or
// on the buckets, and buckets are unions of atoms.
inline constexpr std::int32_t kAtomSizePixels = 8;
inline constexpr std::int32_t kAtomPixels = kAtomSizePixels * kAtomSizePixels;
inline constexpr std::int32_t kMinBucketSizePixels = 8;
inline constexpr std::int32_t kMaxBucketSizePixels = 1024;

// Errors: kInvalidArgument where a coordinate of the window is beyond +-2^29.
void checkWindow(const Rect& window);

// The smallest rectangle of whole atoms that holds the given one; what a renderer works on where a
// bucket was clipped by the window.
Rect wholeAtoms(const Rect& pixels);

// The atoms that a bucket has pixels of. bucket: not empty.
std::int32_t atomCount(const Rect& bucket);

// Its pixels of one of them. index: row by row, from 0, below atomCount().
Rect atomOf(const Rect& bucket, std::int32_t index);

// The size of buckets in pixels where none is asked for: 32, or twice that as often as it takes for
// no more than 65,536 of them. docs/orders.md has the measurement behind it (P15 of the paper of
// Yavuz et al. 2010).
std::int32_t autoBucketSize(const Rect& window);

// The buckets of a window (the crop): a grid of squares whose origin is the window's top left
// corner moved out to the atom grid, each bucket clipped to the window. A plain value.
class BucketGrid {
  public:
    // window: half-open pixels, may be negative (overscan), coordinates within +-2^29; empty gives
    // a grid without buckets. bucketSize: pixels, a multiple of 8 from 8 to 1024.
    // Errors: kInvalidArgument for a bucket size or coordinates that are not allowed, or for more
    // than 2^32 - 1 buckets.
    BucketGrid(const Rect& window, std::int32_t bucketSize);

    const Rect& window() const { return m_window; }
    std::int32_t bucketSize() const { return m_bucketSize; }
    std::int32_t columns() const { return m_columns; }
    std::int32_t rows() const { return m_rows; }
    std::uint32_t cellCount() const {
        return static_cast<std::uint32_t>(m_columns) * static_cast<std::uint32_t>(m_rows);
    }

    // The pixels of a cell, never empty. cell = row * columns() + column, below cellCount().
    Rect cellRect(std::uint32_t cell) const;

    // The area of the largest bucket, in pixels; 0 for an empty grid.
    std::int64_t maxCellArea() const;

  private:
    Rect m_window;
    std::int32_t m_bucketSize{};
    std::int32_t m_originX{}, m_originY{};
    std::int32_t m_columns{}, m_rows{};
};

}  // namespace pm
