// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <tbb/enumerable_thread_specific.h>

#include <atomic>
#include <cstddef>
#include <cstdint>

#include "plugin/textures/held_tiles.h"

namespace pm::plugin {

// The HeldTiles of all threads that look at the pictures of one cache, which must outlive this.
// Threads: any, at once.
class TilesOfThreads {
  public:
    explicit TilesOfThreads(OIIO::ImageCache& cache);

    HeldTiles& mine();
    // For all threads together, bytes.
    void holdAtMost(std::size_t bytes);

  private:
    void divide();

    std::uint64_t m_number;  // no other's in this process
    std::atomic<std::size_t> m_most{0}, m_threads{1}, m_allowance{0};
    tbb::enumerable_thread_specific<HeldTiles> m_tiles;
};

}  // namespace pm::plugin
