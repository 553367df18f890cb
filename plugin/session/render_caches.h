// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: The pm authors
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>

#include "integrator/photons/map/photon_pages.h"
#include "plugin/session/memory_ledger.h"
#include "plugin/session/memory_plan.h"
#include "plugin/session/render_scene.h"
#include "plugin/values/json.h"

namespace pm::plugin {

// The bounded caches of a render, and the ledger that divides among them what the plan holds for
// them together. Threads: all functions from any, at once.
class RenderCaches {
  public:
    // scene: the render's; is kept. photons: null where photon maps are in memory; must outlive
    // this but for its end.
    RenderCaches(std::shared_ptr<const RenderScene> scene, const MemoryPlan& plan,
                 PhotonPaging* photons);

    // The least that the scene's work with, for pilots, which come before the plan divides memory:
    // photons and paths for what the plan and the error's scale are to be. isLimited: memory is, so
    // that this goes for textures as well, which else stay for the render.
    static void holdLeast(const RenderScene& scene, bool isLimited);

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
