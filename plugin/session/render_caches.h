// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>

#include "integrator/photons/map/photon_pages.h"
#include "integrator/transport/plan/plan.h"
#include "plugin/session/memory_ledger.h"
#include "plugin/session/memory_plan.h"
#include "plugin/session/render_scene.h"
#include "plugin/session/setting_values.h"
#include "plugin/values/json.h"
#include "scheduler/buckets/worker_arena.h"

namespace pm::plugin {

// The plan of a render. Its pilots come before memory is divided: while they trace photons and
// paths the scene's caches hold the least that they work with; those of textures, which else stay
// for the render, where memory is limited. Works in parallel in the arena.
Plan planOf(const RenderScene& scene, const SettingValues& values, WorkerArena& arena);

// The bounded caches of a render, and the ledger that divides among them what the plan holds for
// them together. Threads: all functions from any, at once.
class RenderCaches {
  public:
    // scene: the render's; is kept. photons: null where photon maps are in memory; must outlive
    // this but for its end.
    RenderCaches(std::shared_ptr<const RenderScene> scene, const MemoryPlan& plan,
                 PhotonPaging* photons);

    // A bucket is done; from time to time memory moves.
    void bucketDone();
    // For the statistics: what each has now, and how often memory moved.
    Json statistics() const;

  private:
    std::shared_ptr<const RenderScene> m_scene;
    MemoryLedger m_ledger;
    std::atomic<std::uint32_t> m_buckets{0};
};

}  // namespace pm::plugin
