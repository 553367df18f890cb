// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "integrator/caches/cache_watch.h"

namespace pm::plugin {

// What bounded caches had to make for each bucket, over all its passes so far. Threads: all
// functions from any, at once.
class BucketMisses {
    struct Cell {
        std::atomic<std::uint64_t> misses{0}, bytes{0};
    };

  public:
    explicit BucketMisses(std::size_t cells) : m_cells(cells) {}

    struct Count {
        std::uint64_t misses = 0, bytes = 0;
    };
    Count of(std::uint32_t cell) const {
        return {m_cells[cell].misses.load(std::memory_order_relaxed),
                m_cells[cell].bytes.load(std::memory_order_relaxed)};
    }

    // Counts what the calling thread misses while it lives as a bucket's.
    class Counting : private CacheWatch {
      public:
        Counting(BucketMisses& misses, std::uint32_t cell)
            : m_cell(misses.m_cells[cell]), m_scope(this) {}

      private:
        void asked(const CacheAsked& what) override {
            if (!what.missed) return;
            m_cell.misses.fetch_add(1, std::memory_order_relaxed);
            m_cell.bytes.fetch_add(what.bytes, std::memory_order_relaxed);
        }

        Cell& m_cell;
        CacheWatch::Scope m_scope;
    };

  private:
    std::vector<Cell> m_cells;
};

}  // namespace pm::plugin
