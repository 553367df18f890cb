// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "integrator/caches/cache_watch.h"
#include "plugin/textures/watched_input.h"

namespace pm::plugin {

// What bounded caches had to make or read for each bucket, over all its passes so far. Threads: all
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
    // Of textures, in all buckets, by CacheUser.
    std::array<std::uint64_t, kCacheUsers> texelMissesOf() const {
        std::array<std::uint64_t, kCacheUsers> counts{};
        for (std::size_t i = 0; i < kCacheUsers; ++i)
            counts[i] = m_texelMissesOf[i].load(std::memory_order_relaxed);
        return counts;
    }

    // Counts what the calling thread misses while it lives as a bucket's.
    class Counting : private CacheWatch {
      public:
        Counting(BucketMisses& misses, std::uint32_t cell)
            : m_misses(misses), m_cell(misses.m_cells[cell]), m_scope(this) {}

      private:
        void asked(const CacheAsked& what) override {
            if (!what.missed) return;
            m_cell.misses.fetch_add(1, std::memory_order_relaxed);
            m_cell.bytes.fetch_add(what.bytes, std::memory_order_relaxed);
            if (what.cache == texelCache())
                m_misses.m_texelMissesOf[static_cast<std::size_t>(what.user)].fetch_add(
                    1, std::memory_order_relaxed);
        }

        BucketMisses& m_misses;
        Cell& m_cell;
        CacheWatch::Scope m_scope;
    };

  private:
    std::vector<Cell> m_cells;
    std::array<std::atomic<std::uint64_t>, kCacheUsers> m_texelMissesOf{};
};

}  // namespace pm::plugin
