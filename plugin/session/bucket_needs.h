// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <cstdint>
#include <mutex>
#include <vector>

#include "integrator/caches/cache_watch.h"
#include "integrator/tessellation/limit_groups.h"
#include "scheduler/buckets/bucket_grid.h"

namespace pm::plugin {

// Which groups of triangles each bucket asks for, and how many of them a cache holds now: by that
// the order "correlated" chooses. Threads: all functions from any, at once.
class BucketNeeds {
  public:
    // Both must outlive this.
    BucketNeeds(const BucketGrid& grid, const GroupCache& cache);

    // Share, in [0, 1], of the groups that a bucket needs and the cache does not hold: of those
    // that it needed in the pass before, else of those of its neighbours so far. NaN: nobody knows.
    float missing(std::uint32_t cell) const;

    // Notes what the calling thread asks for while it lives as a bucket's; tells the watch
    // that there was, too.
    class Noting : private CacheWatch {
      public:
        // needs: null: none are noted.
        Noting(BucketNeeds* needs, std::uint32_t cell)
            : m_needs(needs), m_cell(cell), m_next(current()), m_scope(needs ? this : m_next) {}
        ~Noting() override;

      private:
        void asked(const CacheAsked& what) override;

        BucketNeeds* m_needs;
        std::uint32_t m_cell;
        CacheWatch* m_next;
        std::vector<std::uint32_t> m_keys;
        Scope m_scope;
    };

  private:
    void add(std::uint32_t cell, std::vector<std::uint32_t>& keys);
    void append(std::uint32_t cell, std::vector<std::uint32_t>& keys) const;

    const BucketGrid& m_grid;
    const GroupCache& m_cache;
    mutable std::mutex m_mutex;
    std::vector<std::vector<std::uint32_t>> m_keys;  // by cell: rising, each once
};

}  // namespace pm::plugin
