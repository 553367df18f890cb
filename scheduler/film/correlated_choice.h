// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <mutex>
#include <span>
#include <vector>

#include "scheduler/buckets/bucket_grid.h"

namespace pm {

// The order "correlated": the next bucket is chosen while rendering. After a bucket a worker goes
// on with that of its four neighbours, not begun yet, of whose needs least is missing in the caches
// or, where nobody tells of caches, whose finished edges agree best; where there is none, with the
// first bucket of the given order that is not begun, and so it starts too.
//
// Edges: the rows and columns of pixels that finished buckets have along a bucket's border. How
// well they agree: the variance of their values (the mean of three channels) over their mean
// squared, all pixels together, so that flat edges of one brightness agree best. Which bucket is
// next depends on who finishes first, so the order differs from run to run; the picture does not.
// Cost: a constant number of operations a bucket and one look at each of its border pixels.
// Source: P10 in the paper of Yavuz et al. 2010, section 2, which names no rule.
// Threads: every member from any, at once; one call at a time for each worker.
class CorrelatedChoice {
  public:
    // Share of what a bucket needs that would have to be made or read, in [0, 1]; NaN where it is
    // not known, and then edges count.
    using Missing = std::function<float(std::uint32_t cell)>;

    // order: cells of grid, each at most once; both must outlive this. workers: their number.
    // missing: empty: edges count.
    CorrelatedChoice(const BucketGrid& grid, std::span<const std::uint32_t> order, int workers,
                     Missing missing = {});

    // The place in the order of the bucket that this worker begins next, each place once;
    // order.size() when there is none left. worker: from 0 to workers - 1.
    std::size_t next(int worker);

    // A bucket is finished. pixels: those of its rectangle, row by row, floatsPerPixel each, of
    // which three from `first` on are looked at.
    void finished(std::uint32_t cell, std::span<const float> pixels, std::size_t floatsPerPixel,
                  std::size_t first);

  private:
    enum Side : std::size_t { kLeft, kRight, kTop, kBottom };
    // Over the pixels of an edge; count is 0 where the bucket is not finished.
    struct Edge {
        float count = 0, sum = 0, sumOfSquares = 0;
        Edge& operator+=(const Edge& other);
    };
    struct Cell {
        std::size_t place = kNowhere;  // in the order
        bool begun = true;             // or not to be rendered
        std::array<Edge, 4> edges{};   // by Side
    };
    static constexpr std::size_t kNowhere = ~std::size_t{0};

    std::uint32_t neighbour(std::uint32_t cell, std::size_t side) const;
    float disagreement(std::uint32_t cell) const;
    float cost(std::uint32_t cell) const;
    std::size_t bestNeighbour(std::uint32_t cell) const;

    const BucketGrid& m_grid;
    const std::span<const std::uint32_t> m_order;
    const Missing m_missing;
    std::mutex m_mutex;  // of what follows
    std::vector<Cell> m_cells;
    std::vector<std::uint32_t> m_last;  // the bucket that each worker begun last; kNoCell at first
    std::size_t m_firstLeft = 0;        // all places before it are begun
};

}  // namespace pm
