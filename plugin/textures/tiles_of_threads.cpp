// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#include "plugin/textures/tiles_of_threads.h"

namespace pm::plugin {

TilesOfThreads::TilesOfThreads(OIIO::ImageCache& cache)
    : m_number([] {
          static std::atomic<std::uint64_t> made{0};
          return made.fetch_add(1) + 1;
      }()),
      m_tiles([this, &cache] {
          m_threads.store(m_tiles.size() + 1, std::memory_order_relaxed);
          divide();
          return HeldTiles(cache, m_allowance);
      }) {}

HeldTiles& TilesOfThreads::mine() {
    // By its number: another may come to stand at the same address.
    thread_local std::uint64_t number = 0;
    thread_local HeldTiles* tiles = nullptr;
    if (number != m_number) {
        tiles = &m_tiles.local();
        number = m_number;
    }
    return *tiles;
}

void TilesOfThreads::holdAtMost(std::size_t bytes) {
    m_most.store(bytes, std::memory_order_relaxed);
    divide();
}

void TilesOfThreads::divide() {
    m_allowance.store(
        m_most.load(std::memory_order_relaxed) / m_threads.load(std::memory_order_relaxed),
        std::memory_order_relaxed);
}

}  // namespace pm::plugin
