// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>
#include <mutex>
#include <optional>
#include <vector>

#include "scheduler/buckets/bucket_grid.h"
#include "scheduler/film/frame_error.h"
#include "scheduler/film/frame_store.h"

namespace pm {

// The error of a frame whose buckets come one by one, each in a store of its own that doesn't stay.
// As FrameStore::estimateError of the whole, but that pixels at a bucket's border have fewer
// neighbours, and that squares of 32 x 32 pixels begin at each bucket's corner (of smaller buckets
// each is a square). So it depends a little on the buckets' size, and not on their order or on
// threads.
// Threads: every member from any, at once.
class BucketErrors {
  public:
    explicit BucketErrors(const BucketGrid& grid);

    // Once for each cell. frame: of its pixels, or of those in the window.
    void add(std::uint32_t cell, const FrameStore& frame);
    // Of the buckets so far; nothing where no pixel has an even and an odd pass.
    std::optional<FrameError> result() const;

    static std::uint64_t memoryBytes(const BucketGrid& grid);

  private:
    double trimmedNoise(double noise, double pixels) const;

    std::int32_t m_squareColumns;        // of a bucket
    std::size_t m_squaresPerBucket;      // m_squareColumns squared
    std::size_t m_mostNoisy;             // so many are left out of the trimmed figure at most
    mutable std::mutex m_mutex;          // of what follows
    std::vector<ErrorSquare> m_squares;  // of each cell
    // The noisiest pixels so far, the least noisy of them first: a heap.
    std::vector<double> m_noisiest;
};

}  // namespace pm
