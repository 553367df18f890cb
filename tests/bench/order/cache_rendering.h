// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
// A scene rendered with caches of any size, again and again.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "scheduler/buckets/bucket_grid.h"
#include "tests/bench/order/cache_replay.h"
#include "tests/bench/order/cache_scenes.h"
#include "tests/bench/order/order_run.h"

namespace pm::bench {

struct CacheRun {
    double seconds = 0;  // of the buckets
    std::uint64_t misses = 0;
    std::vector<std::uint32_t> cells;  // as begun
};

struct CacheRequest {
    std::string order = "hilbert";
    std::uint64_t budget = 0;
    int threads = 1;
    std::uint32_t pause = 0;  // microseconds a miss: the thread sleeps
};

// Threads: one call at a time.
class CacheRendering {
  public:
    explicit CacheRendering(CacheScene scene);

    const CacheScene& scene() const { return m_scene; }

    // Renders with all in memory, and writes down what each bucket asks for: first of all.
    void observe();
    // What buckets ask for of a render that is short of memory, and of one that isn't.
    const CacheTrace& trace() const { return m_trace; }
    const CacheTrace& roomyTrace() const { return m_roomyTrace ? *m_roomyTrace : m_trace; }
    std::uint64_t workingSet() const { return m_trace.workingSet(); }
    std::uint64_t budgetOf(std::uint64_t share) const { return workingSet() / share; }
    double secondsOf(std::uint32_t cell) const { return m_seconds[cell]; }

    CacheRun run(const CacheRequest& request);
    // While photons are traced and maps are made, by one thread.
    std::uint64_t missesOfPhotons(std::uint64_t budget);

    // seed: of random; correlated: as chosen with an eighth of the working set.
    std::vector<std::uint32_t> cellsOf(const std::string& order, std::uint64_t seed = 1);

  private:
    BucketSetting settingOf(const CacheRequest& request, std::uint64_t budgetOfMaps);
    CacheTrace traceOf(std::uint64_t budgetOfMaps);

    CacheScene m_scene;
    BucketGrid m_grid;
    OrderScene m_order;
    CacheTrace m_trace;
    std::optional<CacheTrace> m_roomyTrace;  // where it is another
    std::vector<double> m_seconds;           // of each bucket, all in memory
    std::vector<std::uint32_t> m_correlated;
};

}  // namespace pm::bench
